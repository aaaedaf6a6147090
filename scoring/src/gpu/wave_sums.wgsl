// sum_j c_j exp(-2 pi i k.x_j) for many k: one invocation has one k, a workgroup reads the points together.
//
// Coordinates are fractions of the period in units of 2^-32, frequencies whole: the phase k.x modulo one period is a
// product-sum of integers that wrap around, without an error. k and x may change places.

// x: rows (k); y: terms (x_j); z: terms of a chunk, a multiple of WIDTH; w: chunks.
@group(0) @binding(0) var<storage, read> sizes: vec4<u32>;
@group(0) @binding(1) var<storage, read> rows: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> terms: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> weights: array<vec2<f32>>;
// [chunk][row]
@group(0) @binding(4) var<storage, read_write> chunks: array<vec2<f32>>;

var<workgroup> points: array<vec4<u32>, WIDTH>;
var<workgroup> factors: array<vec2<f32>, WIDTH>;

// Cosine and sine of 2 pi phase / 2^32: WGSL's own may be off by 2^-11. Polynomials of an eighth of a turn either way
// by Moshier (Cephes, sinf.c), in error by less than 2^-23.
fn wave(phase: u32) -> vec2<f32> {
    let quarter = (phase + 0x20000000u) >> 30u;
    let x = f32(bitcast<i32>(phase - (quarter << 30u))) * 1.4629180792671596e-9;
    let y = x * x;
    let sine = x + x * y * (-1.6666654611e-1 + y * (8.3321608736e-3 - y * 1.9515295891e-4));
    let cosine = 1.0 - 0.5 * y
        + y * y * (4.166664568298827e-2 + y * (-1.388731625493765e-3 + y * 2.443315711809948e-5));
    let odd = (quarter & 1u) == 1u;
    return vec2<f32>(
        select(1.0, -1.0, ((quarter + 1u) & 2u) == 2u) * select(cosine, sine, odd),
        select(1.0, -1.0, (quarter & 2u) == 2u) * select(sine, cosine, odd),
    );
}

@compute @workgroup_size(WIDTH)
fn sum_chunks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let across = (sizes.x + WIDTH - 1u) / WIDTH;
    let number = group.y * MAX_GROUPS + group.x;
    let row = number % across * WIDTH + lane;
    let chunk = number / across;
    let k = rows[min(row, sizes.x - 1u)];
    var sum = vec2<f32>(0.0);
    let end = min((chunk + 1u) * sizes.z, sizes.y);
    for (var start = chunk * sizes.z; start < end; start += WIDTH) {
        workgroupBarrier();
        let mine = min(start + lane, sizes.y - 1u);
        points[lane] = terms[mine];
        factors[lane] = weights[mine];
        workgroupBarrier();
        // A tile's sum by itself: fewer roundings in a row.
        var part = vec2<f32>(0.0);
        let count = min(WIDTH, end - start);
        for (var i = 0u; i < count; i += 1u) {
            let product = k * points[i];
            let turn = wave(product.x + product.y + product.z + product.w);
            let c = factors[i];
            part += vec2<f32>(c.x * turn.x + c.y * turn.y, c.y * turn.x - c.x * turn.y);
        }
        sum += part;
    }
    // The last row of workgroups may be longer than all of them.
    if (row < sizes.x && chunk < sizes.w) {
        chunks[chunk * sizes.x + row] = sum;
    }
}

// [chunk][row]
@group(0) @binding(1) var<storage, read> summed: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read_write> sums: array<vec2<f32>>;

// Adds the chunks in their order.
@compute @workgroup_size(WIDTH)
fn add_chunks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    if (row >= sizes.x) {
        return;
    }
    var sum = vec2<f32>(0.0);
    for (var chunk = 0u; chunk < sizes.w; chunk += 1u) {
        sum += summed[chunk * sizes.x + row];
    }
    sums[row] = sum;
}

@group(0) @binding(1) var<storage, read> values: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read> bound: f32;
@group(0) @binding(3) var<storage, read_write> mask: array<u32>;

// Whether the real part exceeds the bound: 32 rows per invocation.
@compute @workgroup_size(WIDTH)
fn mark_hits(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let word = (group.y * MAX_GROUPS + group.x) * WIDTH + lane;
    if (32u * word >= sizes.x) {
        return;
    }
    var bits = 0u;
    let count = min(32u, sizes.x - 32u * word);
    for (var i = 0u; i < count; i += 1u) {
        bits |= select(0u, 1u, values[32u * word + i].x > bound) << i;
    }
    mask[word] = bits;
}
