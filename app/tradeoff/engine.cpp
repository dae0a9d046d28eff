// The ways to compute a part of a scene, tried one after the other: within the run folder for rods, in a
// folder of their own for the others.

#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/log.hpp"
#include "run/session.hpp"
#include "run/stage_kind.hpp"
#include "target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct PartKind {
    const char* name;
    MakeTarget* make; ///< null: rods_target, which needs the run folder
};
constexpr PartKind part_kinds[] = {
    {"rods", nullptr}, {"bed", bed_target}, {"fit", fit_target}, {"field", field_target}};

const PartKind& kind_of_part(Part part) { return part_kinds[static_cast<std::size_t>(part)]; }

std::unique_ptr<Target> target_of(const scene::Scene& scene, const fs::path& results,
                                  const RunContext& context) {
    const auto& [part, kind, limit] = context.tradeoff;
    auto target = kind_of_part(part).make(scene, results, context);
    target->table.part = part;
    target->table.limit = limit;
    return target;
}

using Write = std::function<void(const Tradeoff&)>;

/// Once a second and at the end, for many ways take less.
class Writer {
public:
    explicit Writer(Write write) : write_(std::move(write)) {}

    void now(const Tradeoff& table) {
        write_(table);
        last_ = Clock::now();
    }
    void now_and_then(const Tradeoff& table) {
        if (Clock::now() - last_ > std::chrono::seconds(1))
            now(table);
    }

private:
    Write write_;
    Clock::time_point last_; ///< long ago
};

/// One that cannot be gone says why; false if it was stopped.
bool attempt(Target& target, std::size_t k) {
    Way& way = target.table.ways[k];
    const Way untried = way;
    try {
        if (target.attempt(k))
            return true;
        way = untried;
        return false;
    } catch (const InputError& error) {
        way.status = error.what();
    } catch (const RunError& error) {
        way.status = error.what();
    }
    way.found.clear();
    return true;
}

const Way* known(const std::vector<Way>& earlier, const Way& way) {
    const auto at = std::ranges::find_if(earlier, [&](const Way& other) {
        return other.tried() && other.keys == way.keys && other.setting == way.setting;
    });
    return at == earlier.end() ? nullptr : &*at;
}

/// All ways that are not among the earlier ones. False if it was stopped; what is done by then is written.
bool try_all(Target& target, const std::vector<Way>& earlier, const RunContext& context, const Write& write) {
    Tradeoff& table = target.table;
    const bool rods = table.part == Part::rods;
    Progress progress(context, "tradeoff", static_cast<double>(table.ways.size()),
                      rods ? "settings" : "ways");
    Writer writer(write);
    bool all = true;
    for (std::size_t k = 0; k < table.ways.size() && all; ++k) {
        if (const Way* way = known(earlier, table.ways[k]))
            table.ways[k] = *way;
        else
            all = !context.stopped() && attempt(target, k);
        if (all) {
            progress.update(static_cast<double>(k + 1));
            writer.now_and_then(table);
        }
    }
    for (std::size_t k = 0; k < table.ways.size() && all && !context.stopped(); ++k)
        target.again(table.ways[k]);
    table.finished = all;
    if (std::ranges::any_of(table.ways, &Way::tried))
        writer.now(table);
    return all;
}

/// What the folder holds of this work; none if nothing or if it is to be done again.
std::optional<Tradeoff> earlier_ways(const fs::path& folder, const Tradeoff& wanted,
                                     const RunContext& context) {
    if (context.force) {
        fs::remove_all(folder / "ways"); // runs of beds
        fs::remove(folder / "ways.json");
    }
    const std::optional<Tradeoff> earlier = read_ways(folder);
    if (earlier && earlier->work != wanted.work)
        throw InputError(folder.string() +
                         ": holds the measurement of another scene, or by another version of "
                         "rodwake; choose another folder "
                         "with -o, or --force to replace it");
    return earlier && earlier->limit == wanted.limit ? earlier : std::nullopt;
}

/// What an interrupted measurement of the same work left, but for what a longer limit may bring to its end.
std::vector<Way> earlier_settings(const Session& session, const Tradeoff& wanted) {
    if (session.context.force || !fs::exists(session.directory.file("tradeoff.json")))
        return {};
    Tradeoff earlier = read_tradeoff(session.directory.path());
    if (earlier.work != wanted.work)
        return {};
    if (earlier.limit < wanted.limit)
        std::erase_if(earlier.ways, [](const Way& way) { return way.status == took_too_long; });
    return earlier.ways;
}

} // namespace

std::string to_string(Part part) { return kind_of_part(part).name; }

fs::path ways_folder(const fs::path& results, Part part) { return results / ("tradeoff_" + to_string(part)); }

Tradeoff plan_ways(const scene::Scene& scene, const fs::path& results, const RunContext& context) {
    return target_of(scene, results, context)->table;
}

StageEnd measure_ways(const scene::Scene& scene, const fs::path& results, const RunContext& context) {
    const auto target = target_of(scene, results, context);
    const Tradeoff& table = target->table;
    const fs::path folder = ways_folder(results, table.part);
    refuse_link(folder);
    refuse_link(folder / "log.txt");
    fs::create_directories(folder);
    const FolderLock lock(folder);
    const std::optional<Tradeoff> earlier = earlier_ways(folder, table, context);
    if (earlier && earlier->finished)
        return StageEnd::finished;
    const Logger log = make_logger(context, folder / "log.txt");
    if (!lock.doubt().empty())
        log->warn("{}", lock.doubt());
    log->info("tradeoff: {} ways to compute the {}; the reference is {}", table.ways.size(),
              to_string(table.part), table.reference);
    const auto write = [&](const Tradeoff& now) {
        store::write_atomically(folder / "ways.json", ways_json(now, context.command));
        store::write_atomically(folder / "ways.csv", ways_csv(now));
        write_manifest(folder);
    };
    return try_all(*target, earlier ? earlier->ways : std::vector<Way>{}, context, write)
               ? StageEnd::finished
               : StageEnd::interrupted;
}

namespace {

StageEnd run_tradeoff(Session& session) {
    const auto target = rods_target(session);
    const Tradeoff& table = target->table;
    session.log->info("tradeoff: {} settings, each timed on one thread; the work is {}", table.ways.size(),
                      table.unit);
    if (!target->begin())
        return StageEnd::interrupted;
    const std::vector<Way> earlier = earlier_settings(session, table);
    const bool all = try_all(*target, earlier, session.context, [&](const Tradeoff& now) {
        session.directory.write("tradeoff.json", tradeoff_json(now));
        session.directory.write("tradeoff.csv", tradeoff_csv(now));
    });
    return all && !session.context.stopped() ? StageEnd::finished : StageEnd::interrupted;
}

/// What the settings choose counts for nothing.
std::string tradeoff_key(scene::Scene scene) {
    if (!scene.rods_run)
        return scene::to_plain_toml(key_of_rods(scene));
    scene.rods_run->method.reset();
    scene.variants.clear();
    if (scene.medium && scene.medium->field != scene::FieldBackend::measured) {
        scene.medium->field = scene::FieldBackend::exact;
        scene.medium->table.reset();
    }
    const scene::RodsRun any;
    scene::RodsRun& run = *scene.rods_run;
    run.form = any.form;
    run.rtol = any.rtol;
    run.atol = any.atol;
    run.precision = any.precision;
    run.turning_tolerance = any.turning_tolerance;
    return scene.scan ? scan_key(scene) : scene::to_plain_toml(key_of_rods(scene));
}

std::vector<FileKind> tradeoff_files() {
    using enum Lifetime;
    return {{"ways.json", kept, "the ways to compute a part of a scene that were tried"},
            {"tradeoff.json", kept, "the reference, and the settings that were tried"},
            {"tradeoff.csv", result, "a row a setting: its error and its cost", tradeoff_columns()},
            {"ways.csv", result, "a row a way and quantity: value, bias, scatter, cost", ways_columns()}};
}

} // namespace

StageKind tradeoff_stage() {
    return {.name = "tradeoff",
            .has_table = [](const scene::Scene& s) { return s.rods_run.has_value(); },
            .key = [](const scene::Scene& s) { return tradeoff_key(s); },
            .files = tradeoff_files,
            .run = run_tradeoff};
}

} // namespace rodwake::app
