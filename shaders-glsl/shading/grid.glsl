// Grids of densities: columns along rays and their places. Twin of photon-core's grid.rs and columns.rs.
#ifndef SHADING_GRID_GLSL
#define SHADING_GRID_GLSL

#include "shading/constants.glsl"
#include "shading/float_bits.glsl"
#include "shading/scene.glsl"

// For columns without a limit.
const float GRID_NO_LIMIT = 3.402823466e38;

// A ray in the coordinates of the nodes of a grid, by the distances of normalised space.
struct GridLine {
    vec3 origin;
    vec3 direction;
    vec3 inverse;
};

float grid_row(vec4 row, vec4 at) {
    precise float sum = row.x * at.x + row.y * at.y + row.z * at.z + row.w * at.w;
    return sum;
}

vec3 grid_node(Grid grid, vec4 at) { return vec3(grid_row(grid.x, at), grid_row(grid.y, at), grid_row(grid.z, at)); }

float grid_reciprocal(float part) {
    // Without infinities, which give NaN for rays in the planes between cells.
    precise float inverse = 1.0 / part;
    return abs(part) < 1e-12 ? copysign(1e12, part) : inverse;
}

GridLine grid_line(Grid grid, vec3 origin, vec3 direction) {
    vec3 along = grid_node(grid, vec4(direction, 0.0));
    vec3 inverse = vec3(grid_reciprocal(along.x), grid_reciprocal(along.y), grid_reciprocal(along.z));
    return GridLine(grid_node(grid, vec4(origin, 1.0)), along, inverse);
}

vec3 grid_place(vec3 origin, vec3 direction, float t) {
    precise vec3 at = origin + direction * t;
    return at;
}

// Members of a record are arguments here and below, since `precise` variables computed from them make the compiler hang.
vec3 grid_along(GridLine line, float t) { return grid_place(line.origin, line.direction, t); }

vec3 grid_distances(vec3 edge, vec3 origin, vec3 inverse) {
    precise vec3 distances = (edge - origin) * inverse;
    return distances;
}

// The cell around a place, between node `i` and the next.
ivec3 grid_cell(Grid grid, vec3 at) { return clamp(ivec3(floor(at)), ivec3(0), ivec3(grid.cells)); }

// Entry of the table of bricks: a density, or with the highest bit the index of its nodes.
uint grid_brick(GridTables tables, Grid grid, ivec3 cell) {
    uvec3 brick = uvec3(cell) / GRID_BRICK;
    uvec3 bricks = grid.cells / GRID_BRICK + 1u;
    return tables.bricks[grid.first + (brick.z * bricks.y + brick.y) * bricks.x + brick.x].at;
}

bool grid_is_even(uint brick) { return (brick & GRID_STORED) == 0u; }

float grid_mix(float a, float b, float share) {
    precise float mixed = a + (b - a) * share;
    return mixed;
}

// The densities at the corners of a cell, x fastest: the four of the lower z, and the others.
void grid_corners(GridTables tables, uint brick, ivec3 cell, out vec4 low, out vec4 high) {
    uvec3 within = uvec3(cell) % GRID_BRICK;
    const uint y = GRID_NODES, z = GRID_NODES * GRID_NODES;
    uint first = (brick & ~GRID_STORED) * (GRID_NODES * z) + within.z * z + within.y * y + within.x;
    GridDensities nodes = tables.densities + first;
    low = vec4(nodes[0].at, nodes[1].at, nodes[y].at, nodes[y + 1u].at);
    high = vec4(nodes[z].at, nodes[z + 1u].at, nodes[z + y].at, nodes[z + y + 1u].at);
}

float grid_interpolate(vec4 low, vec4 high, vec3 at) {
    float below = grid_mix(grid_mix(low.x, low.y, at.x), grid_mix(low.z, low.w, at.x), at.y);
    float above = grid_mix(grid_mix(high.x, high.y, at.x), grid_mix(high.z, high.w, at.x), at.y);
    return grid_mix(below, above, at.z);
}

// The density at a place in the coordinates of nodes, from 0 to 1.
float grid_density_at(GridTables tables, Grid grid, vec3 at) {
    if (any(lessThan(at, vec3(0.5))) || any(greaterThan(at, vec3(grid.cells) + 0.5))) return 0.0;
    ivec3 cell = grid_cell(grid, at);
    uint brick = grid_brick(tables, grid, cell);
    if (grid_is_even(brick)) return uintBitsToFloat(brick);
    vec4 low, high;
    grid_corners(tables, brick, cell, low, high);
    return grid_interpolate(low, high, clamp(at - vec3(cell), vec3(0.0), vec3(1.0)));
}

// The density at a point, from 0 to 1.
float grid_density(GridTables tables, Grid grid, vec3 point) {
    return grid_density_at(tables, grid, grid_node(grid, vec4(point, 1.0)));
}

// Whether all channels of a medium have an optical depth above GRID_THICK across the grid, were it full.
bool grid_is_thick(Grid grid, vec3 extinction) {
    float least = min(min(extinction.x, extinction.y), extinction.z);
    precise vec3 across = least * vec3(grid.cells);
    precise vec3 squared = across * across;
    vec3 rows = vec3(dot3(grid.x.xyz, grid.x.xyz), dot3(grid.y.xyz, grid.y.xyz), dot3(grid.z.xyz, grid.z.xyz));
    precise vec3 bound = GRID_THICK * GRID_THICK * rows;
    return all(greaterThan(squared, bound));
}

// A line through a cell, between two places as shares of the cell.
float grid_part_density(vec4 low, vec4 high, vec3 from, vec3 to, float share) {
    precise vec3 at = from + (to - from) * share;
    return grid_interpolate(low, high, at);
}

// The column of a part of a cell from the densities at its ends and in the middle: Simpson's rule, exact for a cubic.
float grid_simpson(float first, float middle, float last, float far) {
    precise float column = far * ((first + 4.0 * middle + last) * (1.0 / 6.0));
    return column;
}

// The column of a first share of it.
float grid_part_column(vec4 low, vec4 high, vec3 from, vec3 to, float far, float share) {
    float first = grid_part_density(low, high, from, to, 0.0);
    float middle = grid_part_density(low, high, from, to, 0.5 * share);
    precise float length = far * share;
    return grid_simpson(first, middle, grid_part_density(low, high, from, to, share), length);
}

// The share that has a column: by Newton's steps, or halves where they leave the bracket.
float grid_part_share(vec4 low, vec4 high, vec3 from, vec3 to, float far, float column) {
    float least = 0.0, most = 1.0;
    precise float share = min(column / grid_part_column(low, high, from, to, far, 1.0), 0.99999994);
    for (uint i = 0u; i < GRID_ROOT_STEPS; i++) {
        precise float excess = grid_part_column(low, high, from, to, far, share) - column;
        if (excess > 0.0) most = share;
        else least = share;
        precise float next = share - excess / (far * grid_part_density(low, high, from, to, share));
        // Not at a density of 0 either.
        share = next >= least && next <= most ? next : 0.5 * (least + most);
    }
    return share;
}

#ifdef GRID_TURNS
// Number of iterations of walks so far.
uint grid_turns = 0u;
#endif

// The part of a line within the box of the grid; it ends before it starts where the line misses the box.
vec2 grid_within_box(Grid grid, GridLine line, float from, float to) {
    vec3 low = grid_distances(vec3(0.5), line.origin, line.inverse);
    vec3 high = grid_distances(vec3(grid.cells) + 0.5, line.origin, line.inverse);
    vec3 near = min(low, high), far = max(low, high);
    return vec2(max(max(near.x, max(near.y, near.z)), from), min(min(far.x, min(far.y, far.z)), to));
}

// Goes along a line through the cells and bricks from one distance to another, until the column is `limit`: the column, and
// the distance there.
vec2 grid_walk(GridTables tables, Grid grid, GridLine line, float from, float to, float limit) {
    vec2 ends = grid_within_box(grid, line, from, to);
    float t = ends.x, end = ends.y;
    precise float column = 0.0;
    float reached = min(t, to);
    if (!(t < end)) return vec2(column, reached);
    bvec3 forwards = greaterThan(line.inverse, vec3(0.0));
    ivec3 cell = grid_cell(grid, grid_along(line, t));
    // The density at `t`, where a part has ended, which is continuous; negative before.
    float density_here = -1.0;
    // Rounding may repeat a cell beside a brick that is crossed in one step.
    uint most = 2u * (grid.cells.x + grid.cells.y + grid.cells.z) + 16u;
    for (uint i = 0u; i < most; i++) {
#ifdef GRID_TURNS
        ++grid_turns;
#endif
        uint brick = grid_brick(tables, grid, cell);
        bool is_even = grid_is_even(brick);
        int width = is_even ? int(GRID_BRICK) : 1;
        ivec3 first = is_even ? cell / int(GRID_BRICK) * int(GRID_BRICK) : cell;
        vec3 exits = grid_distances(vec3(first + ivec3(forwards) * width), line.origin, line.inverse);
        int axis = exits.x <= exits.y && exits.x <= exits.z ? 0 : exits.z < exits.y ? 2 : 1;
        float next = clamp(exits[axis], t, end);
        precise float length = next - t;
        precise float part;
        if (is_even) {
            float density = uintBitsToFloat(brick);
            part = density * length;
            if (part > 0.0 && column + part >= limit) {
                precise float at = t + (limit - column) / density;
                return vec2(limit, clamp(at, t, next));
            }
            density_here = density;
        } else {
            vec4 lower, upper;
            grid_corners(tables, brick, cell, lower, upper);
            vec3 enters = clamp(grid_along(line, t) - vec3(cell), vec3(0.0), vec3(1.0));
            vec3 leaves = clamp(grid_along(line, next) - vec3(cell), vec3(0.0), vec3(1.0));
            if (density_here < 0.0) density_here = grid_interpolate(lower, upper, enters);
            float middle = grid_part_density(lower, upper, enters, leaves, 0.5);
            float there = grid_interpolate(lower, upper, leaves);
            part = grid_simpson(density_here, middle, there, length);
            density_here = there;
            if (part > 0.0 && column + part >= limit) {
                precise float at = t + length * grid_part_share(lower, upper, enters, leaves, length, limit - column);
                return vec2(limit, clamp(at, t, next));
            }
        }
        column += part;
        if (part > 0.0) reached = next;
        if (next >= end) break;
        t = next;
        if (is_even) cell = clamp(grid_cell(grid, grid_along(line, t)), first, first + width - 1);
        cell[axis] = forwards[axis] ? first[axis] + width : first[axis] - 1;
        if (cell[axis] < 0 || cell[axis] > int(grid.cells[axis])) break;
    }
    return vec2(column, reached);
}

// The columns from the start of a segment to the ends of its even parts, from which those to all places follow exactly by a
// walk within one part: Columns of photon-core, whose knots are those of one segment for each invocation.
struct Columns {
    GridTables tables;
    Grid grid;
    GridLine line;
    float step;
};

float columns_knots[GRIDS ? GRID_KNOTS + 1u : 1u];

vec2 columns_part(float step, uint part) {
    precise vec2 ends = vec2(float(part) * step, float(part + 1u) * step);
    return ends;
}

float columns_sum(float a, float b) {
    precise float sum = a + b;
    return sum;
}

// Of a segment of `length` > 0.
Columns columns_new(GridTables tables, Grid grid, vec3 origin, vec3 direction, float length) {
    float step = length / float(GRID_KNOTS);
    Columns columns = Columns(tables, grid, grid_line(grid, origin, direction), step);
    float column = 0.0;
    columns_knots[0] = 0.0;
    for (uint part = 0u; part < GRID_KNOTS; part++) {
        vec2 ends = columns_part(step, part);
        float walked = grid_walk(tables, grid, columns.line, ends.x, ends.y, GRID_NO_LIMIT).x;
        column = columns_sum(column, walked);
        columns_knots[part + 1u] = column;
    }
    return columns;
}

float columns_total() { return columns_knots[GRID_KNOTS]; }

// The column from its start to a distance.
float columns_to(Columns columns, float distance) {
    uint part = uint(clamp(distance / columns.step, 0.0, float(GRID_KNOTS - 1u)));
    vec2 ends = columns_part(columns.step, part);
    float end = min(distance, ends.y);
    float walked = grid_walk(columns.tables, columns.grid, columns.line, ends.x, end, GRID_NO_LIMIT).x;
    return columns_sum(columns_knots[part], walked);
}

// The density at a distance from its start.
float columns_density(Columns columns, float distance) {
    return grid_density_at(columns.tables, columns.grid, grid_along(columns.line, distance));
}

// The distance from its start within which it has a column.
float columns_place(Columns columns, float column) {
    uint part = 0u;
    while (part + 1u < GRID_KNOTS && columns_knots[part + 1u] < column) part++;
    vec2 ends = columns_part(columns.step, part);
    float rest = columns_sum(column, -columns_knots[part]);
    return grid_walk(columns.tables, columns.grid, columns.line, ends.x, ends.y, rest).y;
}

#endif
