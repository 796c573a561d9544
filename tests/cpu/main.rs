//! Tests (cpu).

mod mesh_hierarchy;
mod mesh_obj;
mod mesh_store;
mod teapot;
