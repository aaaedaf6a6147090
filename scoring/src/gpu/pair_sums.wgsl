// Sums of all pairs of two sets of balls: written, or the signed distance from places to the nearest of them.

// x: first row of `first`; y: rows; z: balls of `second`; w: places.
@group(0) @binding(0) var<storage, read> sizes: vec4<u32>;
@group(0) @binding(1) var<storage, read> first: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> second: array<vec4<f32>>;
// [row][ball of second]
@group(0) @binding(3) var<storage, read_write> sums: array<vec4<f32>>;

@compute @workgroup_size(WIDTH)
fn write(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    if (item < sizes.y * sizes.z) {
        sums[item] = first[sizes.x + item / sizes.z] + second[item % sizes.z];
    }
}

// x: tiles of `second` that a workgroup takes.
@group(0) @binding(3) var<storage, read> reach: vec4<u32>;
@group(0) @binding(4) var<storage, read> places: array<vec4<f32>>;
// Per place a key of the negated distance, which grows with it; 0: no pair.
@group(0) @binding(5) var<storage, read_write> nearest: array<atomic<u32>>;

// Beyond all lengths, and its square still a number.
const FAR = 1e18;

var<workgroup> tile: array<vec4<f32>, WIDTH>;
var<workgroup> best: atomic<u32>;

// As integers, keys are in the order of the numbers.
fn key(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, bits >> 31u == 1u);
}

// Distance to the sum of two balls, if below the least so far. |d| - s < least is |d|^2 < (least + s)^2 for a positive
// bracket, so that only a new least takes a root.
fn closer(least: f32, origin: vec4<f32>, ball: vec4<f32>) -> f32 {
    let across = origin.xyz - ball.xyz;
    let square = dot(across, across);
    let radius = origin.w + ball.w;
    let bracket = max(least + radius, 0.0);
    if (square < bracket * bracket) {
        return sqrt(square) - radius;
    }
    return least;
}

@compute @workgroup_size(WIDTH)
fn distances(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let across = (sizes.y + 4u * WIDTH - 1u) / (4u * WIDTH);
    let along = (sizes.z + reach.x * WIDTH - 1u) / (reach.x * WIDTH);
    let number = group.y * MAX_GROUPS + group.x;
    let place = number / (across * along);
    if (place >= sizes.w) {
        return;
    }
    if (lane == 0u) {
        atomicStore(&best, 0u);
    }
    // Beyond the end the last ball is taken again, which changes no minimum.
    let row = number % across * 4u * WIDTH + lane;
    let last = sizes.y - 1u;
    let at = vec4<f32>(places[place].xyz, 0.0);
    let sign = vec4<f32>(-1.0, -1.0, -1.0, 1.0);
    let start0 = at + sign * first[min(row, last)];
    let start1 = at + sign * first[min(row + WIDTH, last)];
    let start2 = at + sign * first[min(row + 2u * WIDTH, last)];
    let start3 = at + sign * first[min(row + 3u * WIDTH, last)];
    var least = vec4<f32>(FAR);
    let start = number / across % along * reach.x;
    for (var step = 0u; step < reach.x; step += 1u) {
        workgroupBarrier();
        tile[lane] = second[min((start + step) * WIDTH + lane, sizes.z - 1u)];
        workgroupBarrier();
        for (var i = 0u; i < WIDTH; i += 1u) {
            let ball = tile[i];
            least.x = closer(least.x, start0, ball);
            least.y = closer(least.y, start1, ball);
            least.z = closer(least.z, start2, ball);
            least.w = closer(least.w, start3, ball);
        }
    }
    atomicMax(&best, key(-min(min(least.x, least.y), min(least.z, least.w))));
    workgroupBarrier();
    if (lane == 0u) {
        atomicMax(&nearest[place], atomicLoad(&best));
    }
}
