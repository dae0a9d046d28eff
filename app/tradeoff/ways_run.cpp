// The ways of a part, tried one after the other.

#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/log.hpp"
#include "tradeoff_files.hpp"
#include "way_subject.hpp"

#include <fmt/format.h>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

WaySubject subject_of(const scene::Scene& scene, const WaysRequest& request, const fs::path& results,
                      const RunContext& context) {
    switch (request.part) {
    case Part::bed:
        return bed_ways(scene, request.limit, ways_folder(results, Part::bed), context);
    case Part::fit:
        return fit_ways(scene, request.limit, results, context);
    case Part::field:
    case Part::rods:
        break;
    }
    return field_ways(scene, context);
}

Ways untried(const WaySubject& subject, const WaysRequest& request) {
    return {request.part, subject.work, subject.reference, request.limit, false, subject.ways};
}

void write(const fs::path& folder, const Ways& ways, const RunContext& context) {
    store::write_atomically(folder / "ways.json", ways_json(ways, context.command));
    store::write_atomically(folder / "ways.csv", ways_csv(ways));
    write_manifest(folder);
}

/// What the folder holds of this work; empty ways if nothing or if it is to be done again.
Ways earlier_ways(const fs::path& folder, const Ways& wanted, const RunContext& context) {
    if (context.force) {
        fs::remove_all(folder / "ways"); // runs of beds
        fs::remove(folder / "ways.json");
    }
    const std::optional<Ways> earlier = read_ways(folder);
    if (!earlier)
        return {};
    if (earlier->work != wanted.work)
        throw InputError(folder.string() +
                         ": holds the measurement of another scene, or by another version of "
                         "rodwake; choose another folder "
                         "with -o, or --force to replace it");
    return earlier->limit == wanted.limit ? *earlier : Ways{};
}

/// One that cannot be gone says why; false if it was stopped.
bool attempt(const WaySubject& subject, std::vector<Way>& ways, std::size_t k) {
    try {
        return subject.attempt(ways, k);
    } catch (const InputError& error) {
        ways[k].status = error.what();
    } catch (const RunError& error) {
        ways[k].status = error.what();
    }
    ways[k].found.clear();
    return true;
}

} // namespace

Ways plan_ways(const scene::Scene& scene, const WaysRequest& request, const fs::path& results,
               const RunContext& context) {
    return untried(subject_of(scene, request, results, context), request);
}

StageEnd measure_ways(const scene::Scene& scene, const WaysRequest& request, const fs::path& results,
                      const RunContext& context) {
    const WaySubject subject = subject_of(scene, request, results, context);
    const fs::path folder = ways_folder(results, request.part);
    Ways ways = untried(subject, request);
    fs::create_directories(folder);
    const FolderLock lock(folder);
    const Ways earlier = earlier_ways(folder, ways, context);
    if (earlier.finished)
        return StageEnd::finished;
    const Logger log = make_logger(context, folder / "log.txt");
    log->info("tradeoff: {} ways to compute the {}; the reference is {}", ways.ways.size(),
              to_string(request.part), ways.reference);
    Progress progress(context, "tradeoff", static_cast<double>(ways.ways.size()), "ways");
    for (std::size_t k = 0; k < ways.ways.size(); ++k) {
        Way& way = ways.ways[k];
        if (k < earlier.ways.size() && (earlier.ways[k].runs > 0 || earlier.ways[k].status != "ok"))
            way = earlier.ways[k];
        else if (context.stopped() || !attempt(subject, ways.ways, k))
            return StageEnd::interrupted;
        ways.finished = k + 1 == ways.ways.size();
        write(folder, ways, context);
        progress.update(static_cast<double>(k + 1));
    }
    return StageEnd::finished;
}

} // namespace rodwake::app
