// The field of a periodic box against the reference table and Ewald's sums.

#include "periodic_cases.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldValues;
using elastic::PeriodicField;

namespace {

struct Row {
    BoxPoint at;
    FieldValues exact; ///< displacement and strain
};

std::vector<Row> table() {
    std::ifstream in(RODWAKE_TEST_DATA "/periodic_field.csv");
    std::vector<Row> rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#' || line[0] == 'x')
            continue;
        std::istringstream cells(line);
        std::vector<double> v;
        for (std::string cell; std::getline(cells, cell, ',');)
            v.push_back(std::stod(cell));
        REQUIRE(v.size() == 10);
        Row row{{v[0], v[1], v[2], v[3], v[4], 0.0}, {}};
        row.exact.displacement = {v[5], v[6]};
        row.exact.strain = {v[7], v[8], v[9]};
        rows.push_back(row);
    }
    return rows;
}

/// Relative to the row's own norms, which is stricter than the header's promise.
double error_of(const FieldValues& got, const FieldValues& exact) {
    const Norms d = distances(got, exact), n = norms(exact);
    return std::max(d[0] / n[0], d[1] / n[1]);
}

constexpr double promised = 1e-10; // periodic.hpp

} // namespace

TEST_CASE("the periodic field agrees with the reference table at every row") {
    const std::vector<Row> rows = table();
    REQUIRE(rows.size() == 60);
    for (const Row& row : rows) {
        CAPTURE(row.at.x, row.at.y, row.at.xi, row.at.eta, row.at.box);
        const FieldValues got =
            field_of(row.at).at(row.at.x, row.at.y, {.displacement = true, .strain = true});
        CHECK(error_of(got, row.exact) < promised);
    }
}

TEST_CASE("a damaged row of the periodic reference is noticed") {
    const Row row = table().front();
    const FieldValues got = field_of(row.at).at(row.at.x, row.at.y, {.displacement = true, .strain = true});
    FieldValues wrong = row.exact;
    wrong.displacement.y *= 1.0 + 1e-6; // U_y is 2 % of U there
    CHECK(error_of(got, wrong) > promised);
    wrong = row.exact;
    std::swap(wrong.strain.xx, wrong.strain.yy);
    CHECK(error_of(got, wrong) > 1e-3);
}

TEST_CASE("Ewald's sums agree with the reference table") {
    for (const Row& row : table())
        CHECK(error_of(periodic_field(row.at), row.exact) <
              1e-14); // long double; the table's numbers as doubles
}

TEST_CASE("the periodic field agrees with Ewald's sums in turned squares and rectangles") {
    RandomStream random(71);
    for (int k = 0; k < 280; ++k) {
        const BoxPoint p = sample(random, k, k % 4 < 2 ? 20.0 : 100.0);
        const PeriodicField field = field_of(p);
        const FieldValues got = field.at(p.x, p.y, plain), exact = periodic_field(p);
        const Norms scale = largest_at(field, std::hypot(p.x, p.y));
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        CHECK(worst(distances(got, exact), scale) < promised);
        FieldValues wrong = exact;
        wrong.laplacian.y += 1e-9 * scale[2];
        CHECK(worst(distances(got, wrong), scale) > promised);
    }
}

TEST_CASE("the periodic field agrees with Ewald's sums in a box of 1000 screening lengths", "[.][long]") {
    RandomStream random(72);
    for (int k = 0; k < 12; ++k) {
        const double r = random.uniform(0.05, 0.5), angle = random.uniform(-3.0, 3.0);
        const BoxPoint p{r * std::cos(angle), r * std::sin(angle), 1e-3, 1.3, 1.0, 0.35 * k};
        const PeriodicField field = field_of(p);
        CAPTURE(k, r, angle);
        CHECK(worst(distances(field.at(p.x, p.y, plain), periodic_field(p)), largest_at(field, r)) <
              promised);
    }
}

TEST_CASE("the comparison with Ewald's sums can fail") {
    const BoxPoint p{0.1, 0.2, 1.0, 1.3, 1.0, 0.3};
    const PeriodicField field = field_of(p);
    const Norms scale = largest_at(field, 0.2236);
    const FieldValues exact = periodic_field(p);
    for (const auto change : {+[](FieldValues& f) -> double& { return f.displacement.x; },
                              +[](FieldValues& f) -> double& { return f.strain.xy; },
                              +[](FieldValues& f) -> double& { return f.laplacian.y; },
                              +[](FieldValues& f) -> double& { return f.gradient_of_trace.x; },
                              +[](FieldValues& f) -> double& { return f.dipole.y; }}) {
        FieldValues wrong = field.at(p.x, p.y, plain);
        change(wrong) *= 1.0 + 1e-7;
        CHECK(worst(distances(wrong, exact), scale) > promised);
        change(wrong) = std::nan("");
        CHECK(worst(distances(wrong, exact), scale) > 1.0);
    }
}
