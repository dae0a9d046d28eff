// rodwake field --points: the field at the points of a CSV file, to standard output.

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/store/csv.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

namespace rodwake::cli {

namespace {

constexpr const char* header = "x,y,xi,eta,Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr,dipUx,dipUy\n";

struct Point {
    double x, y;
    elastic::Medium medium;
    std::size_t line; ///< of the file
};

/// A column L without entries asks for no periodic box.
void refuse_boxes(const std::string& file, const store::Table& table) {
    const auto* boxes = table.find("L");
    for (std::size_t i = 0; boxes && i < boxes->size(); ++i)
        if (!std::isnan((*boxes)[i]))
            throw InputError(fmt::format("{}:{}:1: column L (periodic box) is not available in this version",
                                         file, table.lines[i]));
}

std::vector<Point> read_points(const std::string& file) {
    const std::vector<std::string> required = {"x", "y", "xi", "eta"};
    const std::vector<std::string> optional = {"L"};
    const store::Table table = store::read_csv(file, required, optional);
    refuse_boxes(file, table);
    const auto &x = *table.find("x"), &y = *table.find("y"), &xi = *table.find("xi"),
               &eta = *table.find("eta");
    std::vector<Point> points;
    points.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i)
        points.push_back({x[i], y[i], {eta[i], xi[i]}, table.lines[i]});
    return points;
}

std::string row(const Point& point) {
    const elastic::FieldValues f =
        elastic::Field(point.medium)
            .at(point.x, point.y, {.displacement = true, .strain = true, .polar = true, .dipole = true});
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
    for (const Point& point : points)
        try {
            out.append(row(point));
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
