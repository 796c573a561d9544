// Beams — which way does light go just under each water vertex, and how much of it? One invocation per grid vertex.
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/octahedral.wgsl"
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"
#import "shared/entry.wgsl"

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
// Per vertex: unit direction under water, transmittance T (0 where the surface looks away from the light).
@group(0) @binding(9) var<storage, read_write> beams: array<vec4f>;

@compute @workgroup_size(64)
fn beams_main(@builtin(global_invocation_id) id: vec3u) {
    let side = light.cells + 1u;
    if id.x >= side || id.y >= side { return; }
    let vertex = id.y * side + id.x;
    let entry = entry_at(vec2f(id.xy), surface[vertex].xyz);
    beams[vertex] = vec4f(entry.direction, entry.transmittance);
}
