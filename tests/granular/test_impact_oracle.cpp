// Stronge's law against the reference set and against brute-force integration.

#include "impact_oracle.hpp"

#include "rodwake/core/error.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

struct Row {
    ImpactCase given;
    Eigen::Vector3d impulse, velocity;
    std::string kind;
};

Row parse(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> f;
    for (std::string cell; std::getline(in, cell, ',');)
        f.push_back(cell);
    if (f.size() != 19)
        throw InputError("reference impact with " + std::to_string(f.size()) + " columns: " + line);
    const auto n = [&f](std::size_t i) { return std::stod(f[i]); };
    Row row{{{}, {n(7), n(8), n(9)}, {n(10), n(11)}}, {n(12), n(13), n(14)}, {n(15), n(16), n(17)}, f[0]};
    row.given.inverse_mass << n(1), n(2), n(3), n(2), n(4), n(5), n(3), n(5), n(6);
    return row;
}

std::vector<Row> reference() {
    std::ifstream in(RODWAKE_SOURCE_DIR "/tests/granular/data/stronge_impacts.csv");
    std::vector<Row> rows;
    bool header = true;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with('#'))
            continue;
        if (!header)
            rows.push_back(parse(line));
        header = false;
    }
    return rows;
}

Eigen::Vector3d impulse(const ImpactCase& c) {
    return stronge_impact(c.inverse_mass, c.velocity, c.surface).impulse;
}

double error_of(const ImpactCase& c) { return oracle::relative_error(impulse(c), oracle::impulse(c)); }

void report(const ImpactCase& c) {
    UNSCOPED_INFO("K\n"
                  << c.inverse_mass << "\nv " << c.velocity.transpose() << " mu " << c.surface.friction
                  << " e " << c.surface.restitution);
}

} // namespace

TEST_CASE("impacts agree with the reference set") {
    const std::vector<Row> rows = reference();
    REQUIRE(rows.size() == 240);
    for (const Row& row : rows) {
        const ImpactCase& c = row.given;
        const Impact got = stronge_impact(c.inverse_mass, c.velocity, c.surface);
        CAPTURE(row.kind, c.surface.friction, c.surface.restitution);
        CHECK(oracle::relative_error(got.impulse, row.impulse) < 1e-12); // the accuracy of the set
        const double fastest = c.velocity.norm() + c.inverse_mass.norm() * row.impulse.norm();
        CHECK((got.velocity - row.velocity).norm() < 1e-12 * fastest);
    }
}

TEST_CASE("the oracle agrees with the reference set") {
    const std::vector<Row> rows = reference();
    for (const Row& row : rows)
        CHECK(oracle::relative_error(oracle::impulse(row.given), row.impulse) < 1e-12); // of the set
}

TEST_CASE("the comparison with the oracle can fail") {
    RandomStream random(7);
    ImpactCase c = rod_case(random);
    const Eigen::Vector3d right = impulse(c);
    c.surface.friction *= 1.0 + 1e-9;
    CHECK(oracle::relative_error(right, oracle::impulse(c)) > 1e-11);
    c.surface.friction = 0.5;
    c.surface.restitution *= 1.0 + 1e-9;
    CHECK(oracle::relative_error(right, oracle::impulse(c)) > 1e-11);
    CHECK_THROWS_AS(parse("general,1,2,3"), InputError);
}

TEST_CASE("ordinary impacts agree with brute-force integration") {
    RandomStream random(11);
    for (int k = 0; k < 20; ++k)
        for (const ImpactCase& c :
             {sphere_case(random), planar_case(random), rod_case(random), general_case(random, 100.0)}) {
            const double error = error_of(c);
            if (error >= 1e-12)
                report(c);
            CHECK(error < 1e-12); // what impact.hpp says
        }
}

namespace {

/// What impact.hpp says: each of up to a hundred steps rounds v by eps |K||P|, which P answers with K^-1.
/// That counts for nearly singular K (kind 6) only.
double allowed(const ImpactCase& c, int kind) {
    if (kind != 6)
        return 1e-12;
    const Eigen::Vector3d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(c.inverse_mass).eigenvalues();
    return 1e-13 * values[2] / values[0];
}

void check_hard_cases(int count, std::uint64_t seed) {
    for (int kind = 0; kind < hard_kinds; ++kind) {
        RandomStream random(seed, static_cast<std::uint32_t>(kind));
        for (int k = 0; k < count; ++k) {
            const ImpactCase c = hard_case(random, kind);
            const double error = error_of(c), limit = std::max(1e-12, allowed(c, kind));
            if (!(error < limit))
                report(c);
            CAPTURE(kind, k);
            CHECK(error < limit);
        }
    }
}

} // namespace

TEST_CASE("hard impacts agree with brute-force integration") { check_hard_cases(10, 13); }

TEST_CASE("a thousand hard impacts agree with brute-force integration", "[.][long]") {
    check_hard_cases(100, 99);
}
