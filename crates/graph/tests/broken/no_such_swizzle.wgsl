struct Hit { distance: f32, primitive: u32 }

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let hit = Hit(centre.x, 0u);
    return hit.t;
}
