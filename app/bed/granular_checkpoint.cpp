#include "granular_checkpoint.hpp"

#include "rodwake/app/run.hpp"
#include "rodwake/store/bytes.hpp"
#include "rodwake/store/generations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rodwake::app {

namespace {

using store::Block;
using store::ByteReader;
using store::ByteWriter;

/// Of every block: counted up when what is written changes, so that an older file is refused instead of
/// misread.
constexpr std::uint32_t block_layout = 1;

/// Numbers of one rod in the file: position, velocity, orientation w x y z, angular momentum.
using RodNumbers = std::array<double, 13>;

RodNumbers numbers(const granular::RodBody& r) {
    const auto &x = r.position, &v = r.velocity, &L = r.angular_momentum;
    const auto& q = r.orientation;
    return {x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), q.w(), q.x(), q.y(), q.z(), L.x(), L.y(), L.z()};
}

granular::RodBody rod_of(const RodNumbers& n) {
    return {{n[0], n[1], n[2]},
            {n[3], n[4], n[5]},
            Eigen::Quaterniond(n[6], n[7], n[8], n[9]),
            {n[10], n[11], n[12]}};
}

Block head_block(const GranularCheckpoint& c) {
    ByteWriter out;
    out.put_text(c.scene);
    out.put_text(c.build);
    out.put(c.seed);
    out.put(std::uint64_t{c.run});
    out.put(c.cpu_seconds);
    out.put(c.wall_seconds);
    out.put(c.logs);
    return {"run", out.take(), block_layout};
}

Block state_block(const granular::State& state) {
    ByteWriter out;
    out.put(state.step);
    const granular::Beads& b = state.beads;
    for (const auto* column : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        out.put_array(*column);
    std::vector<RodNumbers> rods;
    for (const granular::RodBody& rod : state.rods)
        rods.push_back(numbers(rod));
    out.put_array(rods);
    return {"state", out.take(), block_layout};
}

void put_vectors(ByteWriter& out, const std::vector<Eigen::Vector3d>& vectors) {
    std::vector<std::array<double, 3>> numbers;
    numbers.reserve(vectors.size());
    for (const Eigen::Vector3d& v : vectors)
        numbers.push_back({v.x(), v.y(), v.z()});
    out.put_array(numbers);
}

std::vector<Eigen::Vector3d> get_vectors(ByteReader& in) {
    std::vector<Eigen::Vector3d> vectors;
    for (const auto& v : in.get_array<std::array<double, 3>>())
        vectors.emplace_back(v[0], v[1], v[2]);
    return vectors;
}

Block tally_block(const granular::Tallies& t) {
    ByteWriter out;
    for (const double value : {t.floor_impulse, t.lid_impulse, t.max_overlap})
        out.put(value);
    for (const std::int64_t value :
         {t.bead_bead, t.bead_plate, t.bead_rod, t.rod_plate, t.rod_rod, t.overlaps})
        out.put(value);
    put_vectors(out, t.impulse_on_beads);
    return {"tallies", out.take(), block_layout};
}

Block thrust_block(const GranularCheckpoint& c) {
    ByteWriter out;
    put_vectors(out, c.tallies.impulse_from_plates);
    out.put_array(c.thrust);
    return {"thrust", out.take(), block_layout};
}

Block pressure_block(const GranularCheckpoint& c) {
    ByteWriter out;
    out.put(c.tallies.virial);
    out.put(c.pressure.value());
    return {"pressure", out.take(), block_layout};
}

Block record_block(const GranularCheckpoint& c) {
    ByteWriter out;
    out.put(c.sums);
    out.put_array(c.progress);
    return {"record", out.take(), block_layout};
}

Block measure_block(const GranularCheckpoint& c) {
    ByteWriter out;
    out.put_text(c.measure_keys);
    out.put_array(c.measures);
    return {"measures", out.take(), block_layout};
}

Block cost_block(const GranularCheckpoint& c) {
    ByteWriter out;
    out.put(c.cost);
    return {"cost", out.take(), block_layout};
}

void read_head(GranularCheckpoint& c, ByteReader in) {
    c.scene = in.get_text();
    c.build = in.get_text();
    c.seed = in.get<std::uint64_t>();
    c.run = static_cast<std::uint32_t>(in.get<std::uint64_t>());
    c.cpu_seconds = in.get<double>();
    c.wall_seconds = in.get<double>();
    c.logs = in.get<LogLengths>();
    in.finish();
}

void read_state(granular::State& state, ByteReader in) {
    state.step = in.get<std::int64_t>();
    granular::Beads& b = state.beads;
    for (auto* column : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        *column = in.get_array<double>();
    for (const RodNumbers& rod : in.get_array<RodNumbers>())
        state.rods.push_back(rod_of(rod));
    in.finish();
}

void read_tallies(granular::Tallies& t, ByteReader in) {
    for (double* value : {&t.floor_impulse, &t.lid_impulse, &t.max_overlap})
        *value = in.get<double>();
    for (std::int64_t* value :
         {&t.bead_bead, &t.bead_plate, &t.bead_rod, &t.rod_plate, &t.rod_rod, &t.overlaps})
        *value = in.get<std::int64_t>();
    t.impulse_on_beads = get_vectors(in);
    in.finish();
}

void read_thrust(GranularCheckpoint& c, ByteReader in) {
    c.tallies.impulse_from_plates = get_vectors(in);
    c.thrust = in.get_array<granular::RodThrust>();
    in.finish();
}

void read_pressure(GranularCheckpoint& c, ByteReader in) {
    c.tallies.virial = in.get<granular::PlaneTensor>();
    c.pressure = in.get<granular::PressureSums>();
    in.finish();
}

void read_measures(GranularCheckpoint& c, ByteReader in) {
    c.measure_keys = in.get_text();
    c.measures = in.get_array<double>();
    in.finish();
}

void read_cost(GranularCheckpoint& c, ByteReader in) {
    c.cost = in.get<RunCost>();
    in.finish();
}

void read_record(GranularCheckpoint& c, ByteReader in) {
    c.sums = in.get<granular::RecordSums>();
    c.progress = in.get_array<granular::RodProgress>();
    in.finish();
}

} // namespace

void write_checkpoint(const std::filesystem::path& file, const GranularCheckpoint& c) {
    const std::array blocks = {head_block(c),   state_block(c.state), tally_block(c.tallies), record_block(c),
                               thrust_block(c), pressure_block(c),    measure_block(c),       cost_block(c)};
    store::write_generation(file, store::encode_blocks(blocks));
}

std::optional<LoadedCheckpoint> load_checkpoint(const std::filesystem::path& file) {
    const auto loaded = store::load_generation(file);
    if (!loaded)
        return std::nullopt;
    const auto block = [&](const char* name) {
        const std::string where = loaded->file.string() + ": block " + name;
        return ByteReader(
            store::find_block(loaded->blocks, name, loaded->file.string(), block_layout).content, where);
    };
    LoadedCheckpoint result{{}, loaded->notice};
    read_head(result.checkpoint, block("run"));
    read_state(result.checkpoint.state, block("state"));
    read_tallies(result.checkpoint.tallies, block("tallies"));
    read_record(result.checkpoint, block("record"));
    // files of earlier versions measure nothing and say nothing of thrust, pressure and cost
    const auto has = [&](const char* name) { return std::ranges::count(loaded->blocks, name, &Block::name); };
    if (has("thrust"))
        read_thrust(result.checkpoint, block("thrust"));
    if (has("pressure"))
        read_pressure(result.checkpoint, block("pressure"));
    if (has("measures"))
        read_measures(result.checkpoint, block("measures"));
    if (has("cost"))
        read_cost(result.checkpoint, block("cost"));
    return result;
}

std::string describe_checkpoint(const std::filesystem::path& file) {
    const auto loaded = load_checkpoint(file);
    const GranularCheckpoint& c = loaded->checkpoint;
    return fmt::format(
        "{}: checkpoint of a granular run by rodwake {}\n{}run {}, seed {}, step {}, {} beads, {} "
        "rods, state {:016x}\n\n{}",
        file.string(), c.build, loaded->notice.empty() ? "" : loaded->notice + "\n", c.run + 1, c.seed,
        c.state.step, c.state.beads.size(), c.state.rods.size(), granular::state_hash(c.state), c.scene);
}

} // namespace rodwake::app
