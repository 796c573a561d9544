// Beams — which way does light go just under each water vertex, and how much of it? One invocation per grid vertex.
#import "lib/refraction.wgsl"
#import "lib/fresnel.wgsl"
#import "lib/attenuation.wgsl"
#import "shared/light.wgsl"

@group(0) @binding(8) var<storage, read> surface: array<vec4f>;
// Per vertex: refracted unit direction, transmittance T (0 where the surface looks away from the sun).
@group(0) @binding(9) var<storage, read_write> beams: array<vec4f>;

@compute @workgroup_size(64)
fn beams_main(@builtin(global_invocation_id) id: vec3u) {
    let side = light.cells + 1u;
    if id.x >= side || id.y >= side { return; }
    let vertex = id.y * side + id.x;
    let slope = surface[vertex].yz;
    let normal = normal_from_slope(slope.x, slope.y);
    let cos_i = dot(normal, light.to_light.xyz);
    let refracted = refract_direction(-light.to_light.xyz, normal, light.ior);
    beams[vertex] = vec4f(refracted.xyz, fresnel_transmittance(cos_i, light.ior));
}
