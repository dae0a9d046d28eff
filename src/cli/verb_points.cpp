// rodwake field --points: the field at the points of a CSV file, to standard output. Rows with a side L are
// in the periodic box of that side, its axes along the rod; the others in the infinite plane.

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/periodic.hpp"
#include "rodwake/store/csv.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <optional>

namespace rodwake::cli {

namespace {

constexpr const char* header = "x,y,xi,eta,Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr,dipUx,dipUy\n";

struct Point {
    double x, y;
    elastic::Medium medium;
    double box;       ///< side of the periodic box; NaN: infinite plane
    std::size_t line; ///< of the file
};

std::vector<Point> read_points(const std::string& file) {
    const std::vector<std::string> required = {"x", "y", "xi", "eta"};
    const std::vector<std::string> optional = {"L"};
    const store::Table table = store::read_csv(file, required, optional);
    const auto &x = *table.find("x"), &y = *table.find("y"), &xi = *table.find("xi"),
               &eta = *table.find("eta");
    const auto* box = table.find("L");
    std::vector<Point> points;
    points.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i)
        points.push_back({x[i], y[i], {eta[i], xi[i]}, box ? (*box)[i] : std::nan(""), table.lines[i]});
    return points;
}

/// Rows of one medium and box follow each other: its field is built once.
class Fields {
public:
    elastic::FieldValues at(const Point& point) {
        constexpr elastic::Wanted all{.displacement = true, .strain = true, .polar = true, .dipole = true};
        if (std::isnan(point.box))
            return elastic::Field(point.medium).at(point.x, point.y, all);
        if (!periodic_ || periodic_->box() != point.box || periodic_->medium().eta != point.medium.eta ||
            periodic_->medium().xi != point.medium.xi)
            periodic_.emplace(point.medium, point.box);
        return periodic_->at(point.x, point.y, all);
    }

private:
    std::optional<elastic::PeriodicField> periodic_;
};

std::string row(const Point& point, Fields& fields) {
    const elastic::FieldValues f = fields.at(point);
    const double values[] = {point.x,
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
    return fmt::format("{:.17g}\n", fmt::join(values, ","));
}

} // namespace

int verb_field_points(const Options& options) {
    if (options.backend != "exact")
        throw InputError("--backend " + options.backend +
                         ": not available in this version; legal here: exact");
    const std::vector<Point> points = read_points(options.points);
    // Every point is evaluated before the first is printed: a bad one leaves nothing half-written.
    fmt::memory_buffer out;
    out.append(std::string_view(header));
    Fields fields;
    for (const Point& point : points)
        try {
            out.append(row(point, fields));
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}:{}:1: {}", options.points, point.line, error.what()));
        }
    if (options.dry_run)
        return 0;
    if (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0)
        throw RunError("cannot write to standard output");
    return 0;
}

} // namespace rodwake::cli
