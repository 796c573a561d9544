//! The projection of a camera, as vision and graphics programs state it.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::types::{Camera, DEFAULT_FIELD_OF_VIEW_DEG};

/// Distance that [`Projection::world_to_ndc`] maps to z = 0, m; infinity maps to 1.
pub const NDC_NEAR_M: f64 = 0.01;

/// Pose and lens of a camera for a picture of a given size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Position of the eye (or the middle of the image plane), m.
    pub eye_m: DVec3,
    /// Unit vectors to the right, up and along the viewing axis.
    pub axes: [DVec3; 3],
    /// The lens.
    pub lens: Lens,
    /// Width and height of the picture, pixels.
    pub pixels: [u32; 2],
}

/// How points in front of a camera become pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Perspective: focal lengths and principal point, pixels from the picture's upper left corner.
    Perspective {
        /// Focal length along x.
        fx: f64,
        /// Focal length along y.
        fy: f64,
        /// Column of the principal point.
        cx: f64,
        /// Row of the principal point.
        cy: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Scale, pixels per metre.
        pixels_per_m: f64,
    },
}

impl Camera {
    /// The projection onto a picture of `width` × `height` pixels. The scene is valid.
    pub fn projection(&self, [width, height]: [u32; 2]) -> Projection {
        let (eye_m, target_m, up) = self.pose();
        let eye_m = DVec3::from(eye_m);
        let forward = (DVec3::from(target_m) - eye_m).normalize();
        let right = forward.cross(DVec3::from(up)).normalize();
        let middle = [width, height].map(|side| 0.5 * f64::from(side));
        let lens = match self {
            Self::Perspective(camera) => match camera.intrinsics {
                Some(i) => Lens::Perspective {
                    fx: i.fx,
                    fy: i.fy,
                    cx: i.cx,
                    cy: i.cy,
                },
                None => {
                    let degrees = camera.vertical_fov_deg.unwrap_or(DEFAULT_FIELD_OF_VIEW_DEG);
                    let focal = middle[1] / (0.5 * degrees.to_radians()).tan();
                    Lens::Perspective {
                        fx: focal,
                        fy: focal,
                        cx: middle[0],
                        cy: middle[1],
                    }
                }
            },
            Self::Orthographic(camera) => Lens::Orthographic {
                pixels_per_m: f64::from(height) / camera.height_m,
            },
        };
        Projection {
            eye_m,
            axes: [right, right.cross(forward), forward],
            lens,
            pixels: [width, height],
        }
    }
}

impl Projection {
    /// Camera coordinates with X to the right, Y up and Z along the viewing axis (left-handed, as in OpenEXR), for column vectors.
    pub fn world_to_camera(&self) -> DMat4 {
        let rows = self.axes.map(|axis| axis.extend(-axis.dot(self.eye_m)));
        DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose()
    }

    /// OpenCV's camera coordinates: X to the right, Y down, Z along the viewing axis; for column vectors.
    pub fn world_to_camera_opencv(&self) -> DMat4 {
        DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)) * self.world_to_camera()
    }

    /// OpenGL's camera coordinates: X to the right, Y up, Z against the viewing axis; for column vectors.
    pub fn world_to_camera_opengl(&self) -> DMat4 {
        DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * self.world_to_camera()
    }

    /// OpenEXR's normalised device coordinates, for column vectors: after division by w, x is 0 … 1 from the left to the right edge,
    /// and y is 0 … 1 from the upper to the lower edge. z is 0 at [`NDC_NEAR_M`] and 1 at infinity (with parallel rays: metres).
    pub fn world_to_ndc(&self) -> DMat4 {
        let [width, height] = self.pixels.map(f64::from);
        let rows = match self.lens {
            Lens::Perspective { fx, fy, cx, cy } => [
                DVec4::new(fx / width, 0.0, cx / width, 0.0),
                DVec4::new(0.0, -fy / height, cy / height, 0.0),
                DVec4::new(0.0, 0.0, 1.0, -NDC_NEAR_M),
                DVec4::Z,
            ],
            Lens::Orthographic { pixels_per_m } => [
                DVec4::new(pixels_per_m / width, 0.0, 0.0, 0.5),
                DVec4::new(0.0, -pixels_per_m / height, 0.0, 0.5),
                DVec4::Z,
                DVec4::W,
            ],
        };
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose() * self.world_to_camera()
    }

    /// Matrix K of a perspective lens, row by row, pixels.
    pub fn k_px(&self) -> Option<[[f64; 3]; 3]> {
        match self.lens {
            Lens::Perspective { fx, fy, cx, cy } => {
                Some([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
            }
            Lens::Orthographic { .. } => None,
        }
    }

    /// Width and centre (right, up) of the picture in the plane at unit distance, as OpenEXR's screen window (with parallel rays: metres).
    pub fn screen_window(&self) -> (f64, DVec2) {
        let [width, height] = self.pixels.map(f64::from);
        match self.lens {
            Lens::Perspective { fx, fy, cx, cy } => {
                let center = DVec2::new((0.5 * width - cx) / fx, (cy - 0.5 * height) / fy);
                (width / fx, center)
            }
            Lens::Orthographic { pixels_per_m } => (width / pixels_per_m, DVec2::ZERO),
        }
    }

    /// Width of a pixel over its height.
    pub fn pixel_aspect(&self) -> f64 {
        match self.lens {
            Lens::Perspective { fx, fy, .. } => fy / fx,
            Lens::Orthographic { .. } => 1.0,
        }
    }

    /// Angles between the edges of the picture along x and y, degrees; `None` for parallel rays.
    pub fn field_of_view_deg(&self) -> Option<[f64; 2]> {
        let Lens::Perspective { fx, fy, cx, cy } = self.lens else {
            return None;
        };
        let angle = |focal: f64, center: f64, side: u32| {
            ((center / focal).atan() + ((f64::from(side) - center) / focal).atan()).to_degrees()
        };
        Some([angle(fx, cx, self.pixels[0]), angle(fy, cy, self.pixels[1])])
    }
}

/// The rows of a matrix.
pub fn rows(matrix: DMat4) -> [[f64; 4]; 4] {
    matrix.transpose().to_cols_array_2d()
}
