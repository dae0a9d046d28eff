#include "wake_fields.hpp"

#include "bed/measured_file.hpp"
#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/journal.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace rodwake::store {

using elastic::CellTable, elastic::PeriodicTableData, elastic::PlaneTable;

template<>
inline constexpr auto parts<CellTable> = parts_of("cells_per_unit polynomial_of coefficients",
                                                  &CellTable::cells_per_unit, &CellTable::polynomial_of,
                                                  &CellTable::coefficients);
template<>
inline constexpr auto
    parts<PlaneTable> = parts_of("eta tolerance strain_error gradient_error points_checked degree "
                                 "lowest_level strain gradient",
                                 &PlaneTable::eta, &PlaneTable::tolerance, &PlaneTable::strain_error,
                                 &PlaneTable::gradient_error, &PlaneTable::points_checked,
                                 &PlaneTable::degree, &PlaneTable::lowest_level, &PlaneTable::strain,
                                 &PlaneTable::gradient);
template<>
inline constexpr auto parts<PeriodicTableData> = parts_of(
    "eta xi box tolerance error place_pieces angle_pieces coefficients", &PeriodicTableData::eta,
    &PeriodicTableData::xi, &PeriodicTableData::box, &PeriodicTableData::tolerance, &PeriodicTableData::error,
    &PeriodicTableData::place_pieces, &PeriodicTableData::angle_pieces, &PeriodicTableData::coefficients);

} // namespace rodwake::store

namespace rodwake::app {

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
    for (const auto& [component, report] :
         {std::pair{"Ux", &fitted->report_x()}, {"Uy", &fitted->report_y()}})
        log_->info("measured field, {}: smoothing {:.3g}, chi2 {:.4g} of {} bins, tr(HR) {:.0f}", component,
                   report->lambda, report->chi2, report->points, report->trace);
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

// A table is kept under all numbers from which it is made. The first is counted up whenever tables are made
// differently.

std::string key_of(double eta, double tolerance) { return fmt::format("plane 2 {} {}", eta, tolerance); }

std::string key_of(const elastic::Medium& medium, double box, double tolerance) {
    return fmt::format("box 2 {} {} {} {}", medium.eta, medium.xi, box, tolerance);
}

/// The kind, and a hash of the key (FNV-1a), which is the same on every machine.
std::string name_of(const std::string& key) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char letter : key)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
    return fmt::format("{}-{:016x}.rwt", key.substr(0, key.find(' ')), hash);
}

/// Throws InputError for cells that do not fit together. Their polynomials have `rows` coefficients.
void require_sound(const elastic::CellTable& cells, std::size_t rows, const fs::path& file) {
    std::size_t count = 0;
    bool sound = cells.cells_per_unit.size() < 100 && cells.coefficients.size() % rows == 0;
    for (const std::int32_t n : cells.cells_per_unit) {
        sound = sound && n >= 1 && n < 10'000;
        count += sound ? 8 * static_cast<std::size_t>(n) * static_cast<std::size_t>(n) : 0;
    }
    const auto polynomials = static_cast<std::int64_t>(cells.coefficients.size() / rows);
    for (const std::int32_t number : cells.polynomial_of)
        sound = sound && number >= -1 && number < polynomials;
    if (!sound || count != cells.polynomial_of.size())
        throw InputError(file.string() + ": is damaged: the cells of the table do not fit together");
}

void require_sound(const PlaneTable& table, const fs::path& file) {
    if (table.degree < 1 || table.degree > 20 || std::abs(table.lowest_level) > 200)
        throw InputError(fmt::format("{}: is damaged: a table of degree {} from level {} on", file.string(),
                                     table.degree, table.lowest_level));
    const std::size_t side = static_cast<std::size_t>(table.degree) + 1, terms = side * side;
    require_sound(table.strain, 3 * terms, file);
    require_sound(table.gradient, 6 * terms, file);
}

std::string table_text(const PlaneTable& table) {
    return fmt::format("table of the wake: tolerance {:g}, largest error {:.2g} of {} points",
                       table.tolerance, table.strain_error, table.points_checked);
}

std::string table_text(const PeriodicTableData& table) {
    return fmt::format("table of the wake in its box: tolerance {:g}, largest error {:.2g}", table.tolerance,
                       table.error);
}

/// A table from its file, or made and kept there. Without a folder none is kept.
template<class Table, class Make>
Table kept(const RunContext& context, const fs::path& folder, const std::string& key, const Make& make) {
    const fs::path file = folder.empty() ? folder : folder / name_of(key);
    const auto log_line = [&](Severity severity, const std::string& text) {
        if (context.log)
            context.log(severity, text);
    };
    try {
        if (!file.empty() && fs::exists(file)) {
            store::Journal journal(file);
            if (journal.key() != key)
                throw InputError(file.string() + ": is the table of another medium");
            Table table = journal.value<Table>();
            if constexpr (std::is_same_v<Table, PlaneTable>)
                require_sound(table, file);
            return table;
        }
    } catch (const std::exception& error) {
        log_line(Severity::warning, fmt::format("{}; it will be recomputed", error.what()));
    }
    Table table = make();
    log_line(Severity::info, table_text(table) + (file.empty() ? "" : ", " + file.string()));
    try {
        if (!file.empty()) {
            fs::create_directories(file.parent_path());
            store::write_atomically(file, store::journal_of(key, table));
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

std::string table_file_name(double eta, double tolerance) { return name_of(key_of(eta, tolerance)); }

std::string table_file_name(const elastic::Medium& medium, double box, double tolerance) {
    return name_of(key_of(medium, box, tolerance));
}

std::shared_ptr<const PlaneTable> WakeTables::plane(double eta, double tolerance) {
    const std::scoped_lock lock(mutex_);
    auto& table = planes_[{eta, tolerance}];
    if (!table)
        table = std::make_shared<const PlaneTable>(
            kept<PlaneTable>(context_, folder_, key_of(eta, tolerance), [&] {
                return elastic::make_plane_table(eta, tolerance, context_.thread_count());
            }));
    return table;
}

PeriodicTable WakeTables::periodic(const elastic::Medium& medium, double box, double tolerance) {
    const std::scoped_lock lock(mutex_);
    const std::array key{medium.eta, medium.xi, box, tolerance};
    if (const auto known = boxes_.find(key); known != boxes_.end())
        return known->second;
    const auto data = kept<PeriodicTableData>(context_, folder_, key_of(medium, box, tolerance), [&] {
        return PeriodicTable(medium, box, tolerance, context_.thread_count()).data();
    });
    return boxes_.emplace(key, PeriodicTable(data)).first->second;
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
