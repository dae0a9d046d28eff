// rodwake field --points: the field at the points of a CSV file, to standard output. Rows with a side L are
// in the periodic box of that side, its axes along the rod; the others in the infinite plane. A point where
// there is no field (the rod itself, a medium that does not exist) has nan there, and does not take the
// others with it.

#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/store/csv.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

namespace rodwake::cli {

namespace {

constexpr const char* points_header =
    "x,y,xi,eta,Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr,dipUx,dipUy\n";

struct QueryPoint {
    double x, y;
    elastic::Medium medium;
    double box;       ///< side of the periodic box; NaN: infinite plane
    std::size_t line; ///< of the file
};

/// Rows of one medium and box follow each other: its wake is built once.
class WakeCache {
public:
    WakeCache(const Options& options, const std::vector<QueryPoint>& points)
        : tolerance_(options.table_tolerance), tables_(context_) {
        if (options.backend == "table")
            for (const QueryPoint& point : points)
                ++count_[point.medium.eta];
    }

    elastic::FieldValues at(const QueryPoint& point) {
        constexpr elastic::FieldRequest all{
            .displacement = true, .strain = true, .polar = true, .dipole = true};
        const bool same_box = point.box == last_.box || (std::isnan(point.box) && std::isnan(last_.box));
        if (!wake_ || !same_box || point.medium.eta != last_.medium.eta ||
            point.medium.xi != last_.medium.xi) {
            const auto count = count_.find(point.medium.eta);
            const bool table =
                std::isnan(point.box) && count != count_.end() && count->second >= worth_a_table;
            const std::shared_ptr<const elastic::WakeField> field =
                !std::isnan(point.box) ? elastic::exact_field(point.medium, point.box)
                : table ? elastic::table_field(tables_.plane(point.medium.eta, tolerance_), point.medium)
                        : elastic::exact_field(point.medium);
            wake_ = field->wake(0.0);
            last_ = point;
        }
        return wake_->at(point.x, point.y, all);
    }

private:
    /// Making a table takes as long as some million points.
    static constexpr std::size_t worth_a_table = 1000;

    double tolerance_;
    app::RunContext context_;
    app::WakeTables tables_;
    std::map<double, std::size_t> count_; ///< points of each eta, if tables are wanted
    QueryPoint last_{};
    std::shared_ptr<const elastic::Wake> wake_; ///< of last_
};

using Row = std::array<double, 15>;

} // namespace

int verb_field_points(const Options& options) {
    const std::vector<std::string> required = {"x", "y", "xi", "eta"};
    const std::vector<std::string> optional = {"L"};
    const store::Table table = store::read_csv(options.points, required, optional);
    const auto &x = *table.find("x"), &y = *table.find("y"), &xi = *table.find("xi"),
               &eta = *table.find("eta");
    const auto* box = table.find("L");
    std::vector<QueryPoint> points;
    points.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i)
        points.push_back({x[i], y[i], {eta[i], xi[i]}, box ? (*box)[i] : std::nan(""), table.lines[i]});
    fmt::memory_buffer out;
    out.append(std::string_view(points_header));
    WakeCache wakes(options, points);
    std::vector<std::string> failed;
    for (const QueryPoint& point : points) {
        Row values;
        values.fill(std::nan(""));
        values[0] = point.x;
        values[1] = point.y;
        values[2] = point.medium.xi;
        values[3] = point.medium.eta;
        try {
            const elastic::FieldValues f = wakes.at(point);
            values = Row{point.x,
                         point.y,
                         point.medium.xi,
                         point.medium.eta,
                         f.displacement.x,
                         f.displacement.y,
                         f.strain.xx,
                         f.strain.xy,
                         f.strain.yy,
                         f.laplacian.x,
                         f.laplacian.y,
                         f.gradient_of_trace.x,
                         f.gradient_of_trace.y,
                         f.dipole.x,
                         f.dipole.y};
        } catch (const InputError& error) {
            failed.push_back(fmt::format("{}:{}:1: {}",
                                         options.points == "-" ? "standard input" : options.points,
                                         point.line, error.what()));
        }
        fmt::format_to(std::back_inserter(out), "{:.17g}\n", fmt::join(values, ","));
    }
    if (!options.dry_run &&
        (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0))
        throw RunError("cannot write to standard output");
    for (const std::string& message : failed)
        print_message(fmt::format("rodwake: {}\n", message));
    if (failed.empty())
        return 0;
    print_message(fmt::format("rodwake: {} of {} points have no field: nan in their rows\n", failed.size(),
                              points.size()));
    return 3;
}

} // namespace rodwake::cli
