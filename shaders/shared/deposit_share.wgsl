// Deposits a footprint's shares on every texel it covers.

// Adds `share` of the flux at texel (x, y); returns the share that lies outside the map.
fn deposit_share(target_map: Target, x: i32, y: i32, share: f32, triangle_flux: vec3f) -> f32 {
    if x < 0 || y < 0 || x >= target_map.width || y >= target_map.height { return share; }
    let texel = target_map.offset + u32(y * target_map.width + x);
    let counts = triangle_flux * (share * target_map.scale);
    add_flux(texel, 0u, target_map.channels, counts.x);
    if target_map.channels == 3u {
        add_flux(texel, 1u, 3u, counts.y);
        add_flux(texel, 2u, 3u, counts.z);
    }
    return 0.0;
}
