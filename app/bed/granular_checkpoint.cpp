#include "granular_checkpoint.hpp"

#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/generations.hpp"
#include "rodwake/store/journal.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::store {

using namespace granular;
using app::GranularArchive, app::GranularCheckpoint, app::LogLengths, app::RunCost;

template<>
inline constexpr auto parts<Beads> = parts_of("x y z vx vy vz wx wy wz radius kind", &Beads::x, &Beads::y,
                                              &Beads::z, &Beads::vx, &Beads::vy, &Beads::vz, &Beads::wx,
                                              &Beads::wy, &Beads::wz, &Beads::radius, &Beads::kind);
template<>
inline constexpr auto parts<RodBody> = parts_of("position velocity orientation angular_momentum",
                                                &RodBody::position, &RodBody::velocity, &RodBody::orientation,
                                                &RodBody::angular_momentum);
template<>
inline constexpr auto parts<State> = parts_of("step beads rods", &State::step, &State::beads, &State::rods);
template<>
inline constexpr auto parts<Counters> = parts_of(
    "floor_impulse lid_impulse bead_bead bead_plate bead_rod rod_plate rod_rod "
    "wall_impulse bead_wall rod_wall overlaps max_overlap virial impulse_on_beads impulse_from_plates",
    &Counters::floor_impulse, &Counters::lid_impulse, &Counters::bead_bead, &Counters::bead_plate,
    &Counters::bead_rod, &Counters::rod_plate, &Counters::rod_rod, &Counters::wall_impulse,
    &Counters::bead_wall, &Counters::rod_wall, &Counters::overlaps, &Counters::max_overlap, &Counters::virial,
    &Counters::impulse_on_beads, &Counters::impulse_from_plates);
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
inline constexpr auto parts<GranularCheckpoint> = parts_of(
    "scene build seed run cpu_seconds wall_seconds state tallies sums pressure progress thrust kinds "
    "logs measure_keys measures cost",
    &GranularCheckpoint::scene, &GranularCheckpoint::build, &GranularCheckpoint::seed,
    &GranularCheckpoint::run, &GranularCheckpoint::cpu_seconds, &GranularCheckpoint::wall_seconds,
    &GranularCheckpoint::state, &GranularCheckpoint::tallies, &GranularCheckpoint::sums,
    &GranularCheckpoint::pressure, &GranularCheckpoint::progress, &GranularCheckpoint::thrust,
    &GranularCheckpoint::kinds, &GranularCheckpoint::logs, &GranularCheckpoint::measure_keys,
    &GranularCheckpoint::measures, &GranularCheckpoint::cost);
template<>
inline constexpr auto parts<GranularArchive> = parts_of("scene build seed run states",
                                                        &GranularArchive::scene, &GranularArchive::build,
                                                        &GranularArchive::seed, &GranularArchive::run,
                                                        &GranularArchive::states);

} // namespace rodwake::store

namespace rodwake::app {

namespace {

/// Throws InputError for a state that no run has written: what is read here sizes loops and lists.
void require_state(const granular::State& state, const std::string& file) {
    const granular::Beads& b = state.beads;
    for (const auto* list : {&b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        if (list->size() != b.x.size())
            throw InputError(fmt::format("{}: is damaged: its lists of the beads have {} and {} numbers",
                                         file, b.x.size(), list->size()));
    if ((!b.radius.empty() && b.radius.size() != b.size()) || (!b.kind.empty() && b.kind.size() != b.size()))
        throw InputError(fmt::format("{}: is damaged: {} beads have {} radii and {} kinds", file, b.size(),
                                     b.radius.size(), b.kind.size()));
    if (state.step < 0)
        throw InputError(fmt::format("{}: is damaged: a state of step {}", file, state.step));
}

} // namespace

void require_end(std::int64_t step, const granular::GranularProblem& problem, const std::string& file) {
    if (step > problem.equilibration_steps + problem.steps)
        throw InputError(fmt::format("{}: is damaged: a state of step {}, and the run has {}", file, step,
                                     problem.equilibration_steps + problem.steps));
}

void write_checkpoint(const std::filesystem::path& file, const GranularCheckpoint& checkpoint) {
    store::write_generation(file, store::journal_of("granular run", checkpoint));
}

std::optional<LoadedCheckpoint> load_checkpoint(const std::filesystem::path& file) {
    const auto found = store::find_generation(file);
    if (!found)
        return std::nullopt;
    LoadedCheckpoint result{store::Journal(found->file).value<GranularCheckpoint>(), found->notice};
    const GranularCheckpoint& c = result.checkpoint;
    require_state(c.state, found->file.string());
    if (c.progress.size() != c.state.rods.size() || c.thrust.size() != c.state.rods.size())
        throw InputError(fmt::format("{}: is damaged: {} rods, of which {} have a path and {} a thrust",
                                     found->file.string(), c.state.rods.size(), c.progress.size(),
                                     c.thrust.size()));
    return result;
}

const granular::State* GranularArchive::before(std::int64_t step) const {
    const auto after = std::ranges::upper_bound(states, step, {}, &granular::State::step);
    return after == states.begin() ? nullptr : &*std::prev(after);
}

static constexpr const char* archive_key = "granular archive";

void write_archive(const std::filesystem::path& file, const GranularArchive& archive) {
    store::write_atomically(file, store::journal_of(archive_key, archive));
}

GranularArchive load_archive(const std::filesystem::path& file) {
    GranularArchive archive = store::Journal(file).value<GranularArchive>();
    if (archive.states.empty())
        throw InputError(file.string() + ": holds no state");
    std::int64_t last = -1;
    for (const granular::State& state : archive.states) {
        require_state(state, file.string());
        const granular::State& first = archive.states.front();
        if (state.beads.size() != first.beads.size() || state.rods.size() != first.rods.size())
            throw InputError(fmt::format(
                "{}: is damaged: {} beads and {} rods at step {}, {} and {} at first", file.string(),
                state.beads.size(), state.rods.size(), state.step, first.beads.size(), first.rods.size()));
        if (state.step <= std::exchange(last, state.step))
            throw InputError(fmt::format("{}: is damaged: the state of step {} is not in order",
                                         file.string(), state.step));
    }
    return archive;
}

std::vector<std::byte> state_bytes(const granular::State& state) { return store::to_bytes(state); }

granular::State state_of(const std::vector<std::byte>& bytes, const std::string& file) {
    granular::State state = store::from_bytes<granular::State>(bytes, file);
    require_state(state, file);
    return state;
}

std::string describe_checkpoint(const std::filesystem::path& file) {
    const std::string key = store::Journal(file).key();
    if (key.starts_with("rods "))
        return fmt::format("{}: state of {}\n", file.string(), key);
    if (key == archive_key) {
        const GranularArchive a = load_archive(file);
        return fmt::format(
            "{}: archive of a granular run by rodwake {}\nrun {}, seed {}, {} states from step {} to "
            "{}, {} beads, {} rods; rodwake replay makes frames of it\n\n{}",
            file.string(), a.build, a.run + 1, a.seed, a.states.size(), a.states.front().step,
            a.states.back().step, a.states.front().beads.size(), a.states.front().rods.size(), a.scene);
    }
    const auto loaded = load_checkpoint(file);
    const GranularCheckpoint& c = loaded->checkpoint;
    const granular::Counters& t = c.tallies;
    return fmt::format(
        "{}: checkpoint of a granular run by rodwake {}\n{}run {}, seed {}, step {}, {} beads, {} "
        "rods, state {:016x}\nimpulses: bead-plate {}, rod-plate {}, bead-bead {}, bead-rod {}, rod-rod {}, "
        "bead-wall {}, rod-wall {}\n\n{}",
        file.string(), c.build, loaded->notice.empty() ? "" : loaded->notice + "\n", c.run + 1, c.seed,
        c.state.step, c.state.beads.size(), c.state.rods.size(), granular::state_hash(c.state), t.bead_plate,
        t.rod_plate, t.bead_bead, t.bead_rod, t.rod_rod, t.bead_wall, t.rod_wall, c.scene);
}

} // namespace rodwake::app
