// The FFT of all lines along one axis of a row-major array, of which some frequencies are kept, each times a factor.
//
// A line is numbered by its place on the other axes: outer * INNER + inner. LINES in a row are those of one workgroup:
// neighbours in memory where INNER > 1, so that invocations run across lines there and along them elsewhere.

@group(0) @binding(0) var<storage, read> twiddle: array<vec2<f32>>;
// [frequency kept]
@group(0) @binding(1) var<storage, read> factors: array<f32>;
// [outer][LENGTH][INNER]
@group(0) @binding(2) var<storage, read> source: array<Source>;
// [outer][KEPT][INNER]
@group(0) @binding(3) var<storage, read_write> kept: array<vec2<f32>>;

// x: line of the workgroup, y: place along it.
fn place(item: u32, length: u32) -> vec2<u32> {
    if (INNER > 1u) {
        return vec2<u32>(item % LINES, item / LINES);
    }
    return vec2<u32>(item / length, item % length);
}

@compute @workgroup_size(WIDTH)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = (group.y * MAX_GROUPS + group.x) * LINES;
    for (var item = lane; item < LINES * LENGTH; item += WIDTH) {
        let here = place(item, LENGTH);
        let line = first + here.x;
        var value = vec2<f32>(0.0);
        if (line < OUTER * INNER) {
            value = vec2<f32>(source[(line / INNER * LENGTH + here.y) * INNER + line % INNER]);
        }
        ping[at(here.x, here.y)] = value;
    }
    workgroupBarrier();
    transform(lane);
    for (var item = lane; item < LINES * KEPT; item += WIDTH) {
        let here = place(item, KEPT);
        let line = first + here.x;
        if (line < OUTER * INNER) {
            // The first frequency kept is -BELOW.
            let frequency = (here.y + LENGTH - BELOW) % LENGTH;
            kept[(line / INNER * KEPT + here.y) * INNER + line % INNER] =
                factors[here.y] * result(here.x, frequency);
        }
    }
}
