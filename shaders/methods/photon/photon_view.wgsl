// Photon view — the depth of what lies under water, drawn from the light (Mihálik 2008, ch. 8). One instance per object.
#import "shared/light_view.wgsl"
#import "shared/normals.wgsl"
#import "shared/geometry.wgsl"

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) y_m: f32,
}

// Local position of a point of an instance's mesh.
fn from_mesh(instance: u32, p: vec3f) -> vec3f {
    let x = instances[instance].mesh_x;
    let y = instances[instance].mesh_y;
    let z = instances[instance].mesh_z;
    let rhs = p - vec3f(x.w, y.w, z.w);
    return (cross(y.xyz, z.xyz) * rhs.x + cross(z.xyz, x.xyz) * rhs.y + cross(x.xyz, y.xyz) * rhs.z) / dot(x.xyz, cross(y.xyz, z.xyz));
}

// Depth runs from the water at rest to the bottom; what lies above or below is clipped.
@vertex
fn photon_view_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    let object = light_view.first_object + instance;
    let at = instances[object].first_triangle + 4u * (index / 3u) + index % 3u;
    let p = from_mesh(object, bitcast<vec3f>(geometry[at].xyz));
    let uv = view_place(p) / f32(light_view.texels);
    return Corner(vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, p.y / min(light_view.bottom_y_m, -1e-6), 1.0), p.y);
}

@fragment
fn photon_view_fragment(in: Corner) -> @location(0) vec4f {
    return vec4f(in.y_m, 0.0, 0.0, 1.0);
}
