#include "wake_fields.hpp"

#include "bed/measured_file.hpp"
#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/table_files.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <initializer_list>
#include <optional>

namespace rodwake::app {

namespace {

void log_smoothing(const Logger& log, const char* component, const elastic::SmoothingReport& report) {
    log->info("measured field, {}: smoothing {:.3g}, chi2 {:.4g} of {} bins, tr(HR) {:.0f}", component,
              report.lambda, report.chi2, report.points, report.trace);
}

} // namespace

std::shared_ptr<const elastic::WakeField> WakeFields::of(const scene::Scene& scene) {
    const scene::Medium& medium = *scene.medium;
    const elastic::Medium constants{medium.eta, medium.xi};
    if (medium.field == scene::FieldBackend::exact ||
        medium.is_dynamic()) // of maps; rods in a dynamic medium have no wake field
        return elastic::exact_field(constants, medium.box());
    if (medium.field == scene::FieldBackend::measured)
        return measured(scene)->field(medium.periodic);
    const double tolerance = medium.table.value_or(scene::FieldTable{}).tolerance;
    if (medium.periodic && !medium.periodic->square())
        throw InputError(
            "medium.field = \"table\" takes a square medium.periodic: take \"exact\" in a rectangle");
    if (medium.periodic)
        return elastic::table_field(tables_.periodic(constants, medium.periodic->x, tolerance));
    return elastic::table_field(tables_.plane(medium.eta, tolerance), constants);
}

std::shared_ptr<const elastic::MeasuredDisplacement> WakeFields::measured(const scene::Scene& scene) {
    const double f_over_mu = scene.scales ? scene.scales->f_over_mu : 0.0;
    for (const Smoothed& smoothed : measured_)
        if (smoothed.medium == *scene.medium && smoothed.f_over_mu == f_over_mu)
            return smoothed.field;
    const MeasuredInput input = read_measured(scene, directory_);
    auto fitted = std::make_shared<const elastic::MeasuredDisplacement>(
        input.grid, elastic::Medium{scene.medium->eta, scene.medium->xi}, input.options);
    log_->info("measured field: {}", input.file.string());
    log_smoothing(log_, "Ux", fitted->report_x());
    log_smoothing(log_, "Uy", fitted->report_y());
    measured_.push_back({*scene.medium, f_over_mu, fitted});
    return fitted;
}

std::shared_ptr<const elastic::WakeField> wake_field(const scene::Scene& scene,
                                                     const std::filesystem::path& folder) {
    const RunContext context;
    return WakeFields(context, folder, make_silent_logger()).of(scene);
}

namespace {

namespace fs = std::filesystem;
using elastic::PeriodicTable;
using elastic::PeriodicTableData;
using elastic::PlaneTable;

/// Counted up whenever tables are made differently: files of the old way are then not found.
constexpr std::uint64_t making = 1;

/// FNV-1a: names differ where the numbers do, on every machine alike.
std::string hashed(const char* kind, std::initializer_list<double> numbers) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    const auto take = [&](std::uint64_t word) {
        for (int byte = 0; byte < 8; ++byte)
            hash = (hash ^ ((word >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
    };
    take(making);
    for (const double number : numbers)
        take(std::bit_cast<std::uint64_t>(number));
    return fmt::format("{}-{:016x}.rwt", kind, hash);
}

bool is_of(const PlaneTable& table, const PlaneTable& wanted) {
    return table.eta == wanted.eta && table.tolerance == wanted.tolerance;
}

bool is_of(const PeriodicTableData& table, const PeriodicTableData& wanted) {
    return table.eta == wanted.eta && table.xi == wanted.xi && table.box == wanted.box &&
           table.tolerance == wanted.tolerance;
}

std::string table_text(const PlaneTable& table) {
    return fmt::format("table of the wake: tolerance {:g}, largest error {:.2g} of {} points",
                       table.tolerance, table.strain_error, table.points_checked);
}

std::string table_text(const PeriodicTableData& table) {
    return fmt::format("table of the wake in its box: tolerance {:g}, largest error {:.2g}", table.tolerance,
                       table.error);
}

/// Nothing if there is no such file. Throws InputError for one that is damaged or of something else.
template<class Table>
std::optional<Table> read(const fs::path& file, const Table& wanted) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        return std::nullopt;
    std::string bytes(fs::file_size(file), '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    Table table = decode<Table>(bytes, file.string());
    if (!is_of(table, wanted))
        throw InputError(file.string() + ": is the table of another medium");
    return table;
}

/// A table from its file, or made and kept there. `wanted` has what it is made from; without a name none is
/// kept.
template<class Table, class Make>
Table kept(const RunContext& context, const fs::path& file, const Table& wanted, const Make& make) {
    const auto log_line = [&](Severity severity, const std::string& text) {
        if (context.log)
            context.log(severity, text);
    };
    try {
        if (auto table = file.empty() ? std::nullopt : read(file, wanted))
            return std::move(*table);
    } catch (const std::exception& error) {
        log_line(Severity::warning, fmt::format("{}; it will be recomputed", error.what()));
    }
    Table table = make();
    log_line(Severity::info, table_text(table) + (file.empty() ? "" : ", " + file.string()));
    try {
        if (!file.empty()) {
            fs::create_directories(file.parent_path());
            store::write_atomically(file, encode(table));
        }
    } catch (const std::exception& error) {
        log_line(Severity::warning, fmt::format("the table of the wake is not kept: {}", error.what()));
    }
    return table;
}

} // namespace

fs::path table_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
        return fs::path(cache) / "rodwake";
    if (const char* home = std::getenv("HOME"); home && *home == '/')
        return fs::path(home) / ".cache" / "rodwake";
    return {};
}

std::string table_file_name(double eta, double tolerance) { return hashed("plane", {eta, tolerance}); }

std::string table_file_name(const elastic::Medium& medium, double box, double tolerance) {
    return hashed("box", {medium.eta, medium.xi, box, tolerance});
}

std::shared_ptr<const PlaneTable> WakeTables::plane(double eta, double tolerance) {
    const std::scoped_lock lock(mutex_);
    auto& table = planes_[{eta, tolerance}];
    if (!table)
        table = std::make_shared<const PlaneTable>(read_or_make_plane(eta, tolerance));
    return table;
}

PeriodicTable WakeTables::periodic(const elastic::Medium& medium, double box, double tolerance) {
    const std::scoped_lock lock(mutex_);
    const std::array key{medium.eta, medium.xi, box, tolerance};
    if (const auto known = boxes_.find(key); known != boxes_.end())
        return known->second;
    return boxes_.emplace(key, read_or_make_box(medium, box, tolerance)).first->second;
}

PlaneTable WakeTables::read_or_make_plane(double eta, double tolerance) const {
    PlaneTable wanted;
    wanted.eta = eta;
    wanted.tolerance = tolerance;
    const fs::path file = folder_.empty() ? folder_ : folder_ / table_file_name(eta, tolerance);
    return kept(context_, file, wanted,
                [&] { return elastic::make_plane_table(eta, tolerance, context_.thread_count()); });
}

PeriodicTable WakeTables::read_or_make_box(const elastic::Medium& medium, double box,
                                           double tolerance) const {
    PeriodicTableData wanted;
    wanted.eta = medium.eta;
    wanted.xi = medium.xi;
    wanted.box = box;
    wanted.tolerance = tolerance;
    const fs::path file = folder_.empty() ? folder_ : folder_ / table_file_name(medium, box, tolerance);
    return PeriodicTable(kept(context_, file, wanted, [&] {
        return PeriodicTable(medium, box, tolerance, context_.thread_count()).data();
    }));
}

bool has_new_field(const scene::Scene& scene, const StageChanges& all) {
    const bool fitted = scene.medium && scene.medium->fitted;
    return (fitted && all.redone(Stage::fit)) ||
           (measures_own_field(scene) && (all.redone(Stage::measure) || all.redone(Stage::granular)));
}

void read_field_file(PlanInputs&, const scene::Scene& scene, const InputRequest& request) {
    require_measured(scene, request.folder, request.made_later);
}

scene::FieldBackend field_of(const RodsPlan& plan) {
    const auto& medium = plan.of.scene.medium;
    return medium ? medium->field : scene::FieldBackend::exact;
}

} // namespace rodwake::app
