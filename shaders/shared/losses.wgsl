// A beam's contribution to the energy account.
struct Losses {
    missed: f32,
    extinguished: vec3f,
    left: vec3f,
    landed: vec3f, // on maps that are not requested
}

const NO_LOSSES: Losses = Losses(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
