#include "granular_checkpoint.hpp"

#include "rodwake/app/run.hpp"
#include "rodwake/store/archive.hpp"
#include "rodwake/store/generations.hpp"

#include <fmt/format.h>

namespace rodwake::store {

using namespace granular;
using app::GranularCheckpoint, app::LogLengths, app::RunCost;

template<>
inline constexpr auto parts<Beads> = parts_of("x y z vx vy vz wx wy wz", &Beads::x, &Beads::y, &Beads::z,
                                              &Beads::vx, &Beads::vy, &Beads::vz, &Beads::wx, &Beads::wy,
                                              &Beads::wz);
template<>
inline constexpr auto parts<RodBody> = parts_of("position velocity orientation angular_momentum",
                                                &RodBody::position, &RodBody::velocity, &RodBody::orientation,
                                                &RodBody::angular_momentum);
template<>
inline constexpr auto parts<State> = parts_of("step beads rods", &State::step, &State::beads, &State::rods);
template<>
inline constexpr auto parts<Tallies> = parts_of(
    "floor_impulse lid_impulse bead_bead bead_plate bead_rod rod_plate rod_rod "
    "wall_impulse bead_wall rod_wall overlaps max_overlap virial impulse_on_beads impulse_from_plates",
    &Tallies::floor_impulse, &Tallies::lid_impulse, &Tallies::bead_bead, &Tallies::bead_plate,
    &Tallies::bead_rod, &Tallies::rod_plate, &Tallies::rod_rod, &Tallies::wall_impulse, &Tallies::bead_wall,
    &Tallies::rod_wall, &Tallies::overlaps, &Tallies::max_overlap, &Tallies::virial,
    &Tallies::impulse_on_beads, &Tallies::impulse_from_plates);
template<>
inline constexpr auto parts<SampleSums> = parts_of("T_xy T_z count", &SampleSums::T_xy, &SampleSums::T_z,
                                                   &SampleSums::count);
template<>
inline constexpr auto parts<PairProgress> = parts_of("change half_box_time half_box_change",
                                                     &PairProgress::change, &PairProgress::half_box_time,
                                                     &PairProgress::half_box_change);
template<>
inline constexpr auto parts<RecordSums> = parts_of("run row psi6 rows overlaps row_step pair",
                                                   &RecordSums::run, &RecordSums::row, &RecordSums::psi6,
                                                   &RecordSums::rows, &RecordSums::overlaps,
                                                   &RecordSums::row_step, &RecordSums::pair);
template<>
inline constexpr auto parts<PressureSums> = parts_of("run_flux row_flux run_virial row_virial",
                                                     &PressureSums::run_flux, &PressureSums::row_flux,
                                                     &PressureSums::run_virial, &PressureSums::row_virial);
template<>
inline constexpr auto parts<RodProgress> =
    parts_of("x0 y0 heading0 x y heading travelled impulse_on_beads_at impulse_on_beads row_travelled",
             &RodProgress::x0, &RodProgress::y0, &RodProgress::heading0, &RodProgress::x, &RodProgress::y,
             &RodProgress::heading, &RodProgress::travelled, &RodProgress::impulse_on_beads_at,
             &RodProgress::impulse_on_beads, &RodProgress::row_travelled);
template<>
inline constexpr auto parts<RodThrust> = parts_of("impulse_at impulse", &RodThrust::impulse_at,
                                                  &RodThrust::impulse);
template<>
inline constexpr auto parts<LogLengths> = parts_of("rows frames period_frames", &LogLengths::rows,
                                                   &LogLengths::frames, &LogLengths::period_frames);
template<>
inline constexpr auto parts<RunCost> = parts_of(
    "start flight rods search impulses records measures output other particle_steps", &RunCost::start,
    &RunCost::flight, &RunCost::rods, &RunCost::search, &RunCost::impulses, &RunCost::records,
    &RunCost::measures, &RunCost::output, &RunCost::other, &RunCost::particle_steps);
template<>
inline constexpr auto parts<GranularCheckpoint> =
    parts_of("scene build seed run cpu_seconds wall_seconds state tallies sums pressure progress thrust logs "
             "measure_keys measures cost",
             &GranularCheckpoint::scene, &GranularCheckpoint::build, &GranularCheckpoint::seed,
             &GranularCheckpoint::run, &GranularCheckpoint::cpu_seconds, &GranularCheckpoint::wall_seconds,
             &GranularCheckpoint::state, &GranularCheckpoint::tallies, &GranularCheckpoint::sums,
             &GranularCheckpoint::pressure, &GranularCheckpoint::progress, &GranularCheckpoint::thrust,
             &GranularCheckpoint::logs, &GranularCheckpoint::measure_keys, &GranularCheckpoint::measures,
             &GranularCheckpoint::cost);

} // namespace rodwake::store

namespace rodwake::app {

void write_checkpoint(const std::filesystem::path& file, const GranularCheckpoint& checkpoint) {
    const store::Block block = store::to_block("granular run", checkpoint);
    store::write_generation(file, store::encode_blocks({&block, 1}));
}

std::optional<LoadedCheckpoint> load_checkpoint(const std::filesystem::path& file) {
    const auto loaded = store::load_generation(file);
    if (!loaded)
        return std::nullopt;
    LoadedCheckpoint result{{}, loaded->notice};
    store::from_block(loaded->blocks, "granular run", loaded->file.string(), result.checkpoint);
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
