// The field that synthetic wakes are displaced by, against values computed elsewhere to 25 digits.

#include "catch2/catch.hpp"

#include "periodic_field.hpp"

#include <cmath>

using measure_test::PeriodicField;

namespace {

struct Row {
    double x, y, xi, eta, box, ux, uy;
};

const Row rows[] = {
    {-0.06875111261202693, -0.08144124797694971, 0.10885158123053958, 0.06873795116939055,
     0.21014035678989718, -0.034992338062755916, 0.0006112090296174472},
    {-0.285990629518313, -4.102371208041005, 4.045621444141346, 0.6970321175757234, 8.553136617856522,
     -0.03970460850685156, -0.00011302550440018069},
    {-0.7003244513172611, 4.078419507659943, 1.1655001516850128, 0.12929252922313575, 17.351594759631357,
     -0.006297738562592127, 0.0018077793126220554},
    {-0.6044026135751821, -0.19263366861649678, 0.37876787268534967, 18.325311731050277, 1.9105227341044364,
     0.037594040077142746, 0.014722238477715923},
    {1.349876545551145, 0.48384029279556573, 3.1220717451746203, 7.333506961272912, 3.5517794116550863,
     0.015002430677166652, 0.007423198573064784},
    {-9.500770777573024, -105.381755420355, 20.073524050051965, 0.18376472258196852, 215.58684983202036,
     -0.04425435400751685, -0.00011378328729695802},
    {0.02447557031309662, -0.02326830556012415, 0.1412421632889458, 2.1971142084338835, 0.1156054298895543,
     0.00573377971636354, -0.01833844612000951},
    {-2.927596364112075, -3.623382840086102, 3.7335320905844145, 4.48015183436043, 9.890123694221323,
     -0.03211107589773744, 0.009530263360762044},
};

double error(const Row& row, const rodwake::elastic::Vector& u) {
    return std::hypot(u.x - row.ux, u.y - row.uy);
}

} // namespace

TEST_CASE("the periodic field is the reference's", "[periodic_field]") {
    for (const Row& row : rows) {
        const PeriodicField field({row.eta, row.xi}, row.box);
        INFO(row.x / row.box << " " << row.y / row.box << " xi/L " << row.xi / row.box << " eta " << row.eta);
        CHECK(error(row, field.exact(row.x, row.y)) < 1e-9); // images are left out below 1e-10
        CHECK(error(row, field.at(row.x, row.y)) < 1e-5);    // interpolation; seen 2.4e-6
        auto wrong = row;
        wrong.uy = -wrong.uy;
        CHECK(error(wrong, field.exact(row.x, row.y)) > 1e-4);
    }
}

TEST_CASE("the periodic field repeats, and its mean over the box is 0", "[periodic_field]") {
    const PeriodicField field({1.3, 20.0}, 78.0);
    const auto u = field.at(11.0, -7.0), image = field.at(11.0 - 78.0, -7.0 + 156.0);
    CHECK(u.x == Approx(image.x).epsilon(1e-12)); // rounding
    CHECK(u.y == Approx(image.y).epsilon(1e-12));
    double sum = 0.0;
    const int n = 156; // odd half steps: not at the rod
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            sum += field.at((i + 0.5) * 0.5 - 39.0, (j + 0.5) * 0.5 - 39.0).x;
    CHECK(std::abs(sum / (n * n)) < 2e-5); // midpoint rule over the logarithm at the rod: (0.5/78)^2
}
