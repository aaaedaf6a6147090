// The gap function on a periodic cube of N^3 points: both solids' bumps as one complex array, and the product of their
// spectra.

// A ball near a block: centre from the block's first point, 1 / r^2; in grid cells.
@group(0) @binding(0) var<storage, read> balls: array<vec4<f32>>;
// [block][solid]: the first ball; and an end.
@group(0) @binding(1) var<storage, read> starts: array<u32>;
// [x][y][z]
@group(0) @binding(2) var<storage, read_write> grid: array<vec2<f32>>;

// psi_2 = exp(-u / (1 - u)), u the square of the distance in radii.
fn bump(ball: vec4<f32>, at: vec3<f32>) -> f32 {
    let across = at - ball.xyz;
    let u = dot(across, across) * ball.w;
    return select(0.0, exp(-u / max(1.0 - u, 1e-7)), u < 1.0);
}

// A workgroup has a block of 4 x 4 x 8 points. Each adds its balls in their order.
@compute @workgroup_size(8, 4, 4)
fn rasterise(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) lane: vec3<u32>,
) {
    let blocks = vec3<u32>((N + 7u) / 8u, (N + 3u) / 4u, (N + 3u) / 4u);
    let block = (group.z * blocks.y + group.y) * blocks.x + group.x;
    let at = vec3<f32>(lane.zyx);
    var value = vec2<f32>(0.0);
    let half = starts[2u * block + 1u];
    for (var i = starts[2u * block]; i < half; i += 1u) {
        value.x += bump(balls[i], at);
    }
    let end = starts[2u * block + 2u];
    for (var i = half; i < end; i += 1u) {
        value.y += bump(balls[i], at);
    }
    let point = group * vec3<u32>(8u, 4u, 4u) + lane;
    if (all(point < vec3<u32>(N))) {
        grid[(point.z * N + point.y) * N + point.x] = value;
    }
}

@group(0) @binding(0) var<storage, read> spectrum: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> product: array<vec2<f32>>;

// A(k) conj(B(k)) of the spectrum A + iB of two real functions; zero on the Nyquist planes.
@compute @workgroup_size(WIDTH)
fn multiply(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let at = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    if (at >= N * N * N) {
        return;
    }
    let k = vec3<u32>(at / (N * N), at / N % N, at % N);
    let back = (vec3<u32>(N) - k) % N;
    let f = spectrum[at];
    let g = spectrum[(back.x * N + back.y) * N + back.z];
    let a = 0.5 * vec2<f32>(f.x + g.x, f.y - g.y);
    let b = 0.5 * vec2<f32>(f.y + g.y, g.x - f.x);
    let both = vec2<f32>(a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y);
    product[at] = select(both, vec2<f32>(0.0), any(2u * k == vec3<u32>(N)));
}
