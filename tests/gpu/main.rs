//! Tests that need an adapter (software Vulkan will do).

mod smoke;
