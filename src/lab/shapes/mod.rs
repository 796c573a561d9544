//! Shapes: meshes from formulas, for experiments, tests and benches; no file is read at run time.
//!
//! A [`Shape`] is made by the builder of its family (`polyhedra`, `stones`, `revolution`, `sweep`, `superquadric`, `blocks`,
//! `implicit`, `height_field`, `plates`, `plants`, `swimmers`, `teapot`) as an [`Outline`]: points and triangles, many of them by
//! `skin`, a skin over a row of rings. Then `normals` computes shading normals, `text` writes OBJ, and [`Shape::mesh`] reads it
//! like an upload. Numbers are rounded to the micrometre and computed from sums, products and square roots only (`turn` for sines,
//! `noise` for random numbers), so that a shape has the same id on every machine.
//!
//! | name | triangles | open edges | what |
//! |---|---:|---:|---|
//! | `bipyramid` | 10 | 0 | Two pyramids over one pentagon |
//! | `box` | 12 | 0 | Cube |
//! | `icosahedron` | 20 | 0 | Twenty equilateral triangles |
//! | `star` | 60 | 0 | Icosahedron with a spike on each face |
//! | `gear` | 256 | 0 | Upright wheel with sixteen teeth |
//! | `icosphere` | 5120 | 0 | Sphere of nearly equal triangles |
//! | `urchin` | 960 | 0 | Sphere with 320 spikes |
//! | `boulder` | 20480 | 0 | Sphere, flattened and worn by noise |
//! | `asteroid` | 81920 | 0 | Rough sphere with noise down to the size of its triangles |
//! | `pebbles` | 12800 | 0 | Heap of forty flat stones, some inside each other |
//! | `sphere` | 1984 | 0 | Sphere of 32 meridians and 31 parallels |
//! | `cylinder` | 192 | 0 | Upright cylinder with flat lids |
//! | `cone` | 128 | 0 | Upright cone |
//! | `torus` | 4608 | 0 | Lying ring |
//! | `washer` | 512 | 0 | Thin flat ring with square edges |
//! | `pipe` | 640 | 0 | Upright thin-walled pipe, open at both ends |
//! | `bowl` | 8192 | 0 | Open bowl with a thick wall |
//! | `vase` | 6112 | 32 | Vase without thickness, open at the top |
//! | `hourglass` | 6048 | 0 | Two cups that meet in a narrow neck |
//! | `saucer` | 2400 | 0 | Flying saucer: lens with a dome |
//! | `colonnade` | 1536 | 0 | Twelve pillars in a ring under a flat ring |
//! | `hammer` | 272 | 0 | Hammer on its handle: two cylinders |
//! | `trefoil_knot` | 6400 | 0 | Tube around the (2, 3) torus knot |
//! | `torus_knot` | 38400 | 0 | Thin tube around the (5, 8) torus knot |
//! | `spring` | 10776 | 0 | Upright coil of seven turns |
//! | `nautilus` | 17260 | 20 | Flat spiral shell, open at its mouth |
//! | `snail` | 28780 | 20 | Tall spiral shell, open at its mouth |
//! | `arch` | 280 | 0 | Round arch of square section |
//! | `chain` | 7680 | 0 | Five interlocked rings |
//! | `rounded_box` | 8064 | 0 | Superellipsoid, exponents ¼: a box with round edges |
//! | `pillow` | 8064 | 0 | Superellipsoid, exponents 1 and ½ |
//! | `caltrop` | 2520 | 0 | Superellipsoid, exponents 3: six tips and hollow sides |
//! | `supertoroid` | 9216 | 0 | Supertoroid, exponents ½ and 2: a square frame of a rounded section |
//! | `stairs` | 300 | 0 | Ten steps |
//! | `cross` | 44 | 0 | Upright cross |
//! | `chair` | 108 | 0 | Chair with four legs and a back |
//! | `sink` | 92 | 0 | Block with a basin |
//! | `bridge` | 300 | 0 | Deck with parapets on six piers |
//! | `towers` | 1884 | 0 | Slab with 36 towers of seven heights |
//! | `lattice` | 4752 | 0 | Cube of thin bars, 36 in each direction |
//! | `menger_sponge` | 36096 | 0 | Menger sponge of the third level |
//! | `gyroid` | 77616 | 0 | Thick gyroid cut to a ball |
//! | `sponge` | 95420 | 0 | Ball with worm holes |
//! | `coral` | 38484 | 0 | Branching coral |
//! | `drops` | 22380 | 0 | Seven balls that have run together |
//! | `terrain` | 299538 | 1548 | Hills and valleys of noise, finely meshed |
//! | `coarse_terrain` | 4608 | 192 | The same hills and valleys, coarsely meshed |
//! | `ripples` | 51200 | 640 | Sand ripples that bend and join |
//! | `crater` | 12800 | 320 | Crater with a rim and a peak in its middle |
//! | `cloth` | 16200 | 360 | Wavy cloth that hangs over at its folds |
//! | `curtain` | 12800 | 464 | Hanging cloth in deep folds |
//! | `plate` | 12 | 0 | Lying plate, a hundredth as thick as wide |
//! | `tilted_plate` | 12 | 0 | The same plate, tilted by 37° |
//! | `sheets` | 320 | 160 | Stack of ten sheets without thickness, each shifted |
//! | `blinds` | 180 | 0 | Fifteen upright plates side by side, edge on from above |
//! | `leaf` | 1536 | 128 | Bent leaf without thickness |
//! | `kelp` | 4224 | 1144 | Eleven twisted upright blades without thickness |
//! | `jellyfish` | 9376 | 0 | Bell with eight arms |
//! | `dolphin` | 4442 | 0 | Slender body with flukes, a back fin and two flippers |
//! | `angelfish` | 4800 | 0 | High, narrow body with long upright fins |
//! | `manta` | 4976 | 0 | Flat body with wide wings and a whip of a tail |
//! | `teapot` | 4032 | 128 | Utah teapot of 32 patches (Newell 1975), without thickness |

mod blocks;
mod catalogue;
mod height_field;
mod implicit;
mod noise;
mod normals;
mod outline;
mod plants;
mod plates;
mod polyhedra;
mod revolution;
mod skin;
mod stones;
mod superquadric;
mod sweep;
mod swimmers;
mod teapot;
mod text;
mod turn;

pub use catalogue::{ALL, Shape};
pub use outline::Outline;
