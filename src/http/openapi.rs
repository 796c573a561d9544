//! The contract, generated from the routes.

use std::sync::OnceLock;

use utoipa::{OpenApi, ToSchema};

use super::problem::Problem;
use super::router;
use crate::methods;
use crate::scene::{MethodChoice, Scene};

/// The parts of the contract that are not routes.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "Caustica",
        description = "Renders water caustics: takes a scene, answers with a picture and its statistics.\n\n\
            Right-handed, Y up, metres, seconds, SI radiometry; angles in degrees; linear RGB. Unknown fields are errors. \
            Every failure is `application/problem+json` with a stable `type`; every answer carries `x-request-id`. \
            Any route may also answer 404, 405 and 503 (`urn:caustica:problem:deadline-passed`). A slash at the end of a path is \
            ignored.\n\n\
            A body may be in one encoding, `Content-Encoding: gzip` or `deflate`; `limits.max_body_bytes` applies to the decoded \
            body.\n\n\
            Browsers let pages of other origins use the service only if its operator allows the origin (CORS, `--cors-origin`).\n\n\
            Connections without a whole request are closed after a time, or when others need the place. Clients should open a new one then.",
        license(name = "MIT or Apache 2.0", identifier = "MIT OR Apache-2.0")
    ),
    tags(
        (name = "render", description = "Rendering of scenes."),
        (name = "meshes", description = "Meshes that scenes refer to."),
        (name = "assets", description = "Files of numbers that scenes refer to: surfaces of water."),
        (name = "service", description = "Health, metrics, limits, contract.")
    ),
    components(schemas(Problem, Scene))
)]
struct Document;

/// The contract without its routes.
pub(super) fn document() -> utoipa::openapi::OpenApi {
    Document::openapi()
}

/// The contract.
pub fn openapi() -> utoipa::openapi::OpenApi {
    let mut contract = router::api().into_openapi();
    if let Some(components) = &mut contract.components {
        // The scene module's own schema of `Method` is generic, because that module does not know the methods.
        let name = MethodChoice::name().into_owned();
        components.schemas.insert(name, methods::schema().into());
    }
    contract
}

/// The contract as YAML, as in `openapi.yaml`.
pub fn yaml() -> &'static str {
    static YAML: OnceLock<String> = OnceLock::new();
    YAML.get_or_init(|| {
        openapi()
            .to_yaml()
            .expect("a generated contract always serialises")
    })
}
