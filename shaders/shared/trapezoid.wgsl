// The trapezoid around the eye's frustum as the light sees it, and the projective map that takes it
// to a square. Martin, Tan, "Anti-aliasing and Continuity with Trapezoidal Shadow Maps", EGSR 2004;
// the dissertation's section 3.1. CPU reference: tests/src/cpu_reference/trapezoid.rs.

// Rows of a matrix on (x, y, 1): x and y of the square from -1 to 1, the near end at y = 1, both to
// be divided by the third.
struct TrapezoidMap {
    x: vec3<f32>,
    y: vec3<f32>,
    w: vec3<f32>,
    // True if there is one: not where the eye looks along the light.
    exists: bool,
}

// How much of the square's height is above the focus: the paper's 80 % line, where y is -0.6.
const FOCUS_LINE: f32 = -0.6;

// `corners`: of the frustum, seen along the light, the near plane's first. `focus` is the distance
// from the near plane, as a share of the way to the far plane, that the first 80 % of the square
// are for.
fn trapezoid_map(corners: array<vec2<f32>, 8>, focus: f32) -> TrapezoidMap {
    let near = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    let far = 0.25 * (corners[4] + corners[5] + corners[6] + corners[7]);
    let way = distance(near, far);
    var none = TrapezoidMap(vec3(0.0), vec3(0.0), vec3(0.0), false);
    if !(way > 0.0) {
        return none;
    }
    // The centre line; top and base lie across it.
    let along = (far - near) / way;
    let across = vec2(-along.y, along.x);
    var top = 3e38;
    var base = -3e38;
    var far_begins = 3e38;
    for (var corner = 0u; corner < 8u; corner++) {
        let place = dot(along, corners[corner] - near);
        top = min(top, place);
        base = max(base, place);
        if corner >= 4u {
            far_begins = min(far_begins, place);
        }
    }
    // The light's direction, or the way back, is in the frustum: the far plane reaches behind the
    // near one, and no side line begins there.
    if far_begins <= 0.0 {
        return none;
    }
    // Where the side lines meet, before the top line: that the focus falls on its line.
    let height = base - top;
    let focused = focus * way - top;
    let remaining_height = (1.0 - FOCUS_LINE) * height - 2.0 * focused;
    // As far off as a rectangle's where the focus asks for more than that.
    let farthest = 1e3 * height;
    let apex = select(
        farthest,
        min(height * focused * (1.0 + FOCUS_LINE) / remaining_height, farthest),
        remaining_height > 0.0,
    );
    if !(apex > 0.0) {
        return none;
    }
    // Slopes of the side lines: through the apex, touching the frustum.
    let begin = top - apex;
    var left = 3e38;
    var right = -3e38;
    for (var corner = 0u; corner < 8u; corner++) {
        let relative = corners[corner] - near;
        let slope = dot(across, relative) / (dot(along, relative) - begin);
        left = min(left, slope);
        right = max(right, slope);
    }
    if !(right > left) {
        return none;
    }
    // With r from the apex and t across: x = (2 t / r - left - right) / (right - left), and
    // y = a + b / r is 1 at the top and -1 at the base.
    let r = vec3(along, -dot(along, near) - begin);
    let t = vec3(across, -dot(across, near));
    let b = 2.0 * apex * (apex + height) / height;
    let a = 1.0 - b / apex;
    return TrapezoidMap(
        (2.0 * t - (left + right) * r) / (right - left),
        a * r + vec3(0.0, 0.0, b),
        r,
        true,
    );
}
