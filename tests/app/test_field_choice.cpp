// medium.field = "auto": which field is chosen, and that the scene alone decides.

#include "rodwake/app/plan.hpp"
#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>

using namespace rodwake;
using app::FieldChoice;
using scene::FieldBackend;

namespace {

struct Keys {
    std::string box = "periodic = 2.0\n", run = "rtol = 1e-8\n", table = "", coupling = "kappa = 1.0\n";
    double t_end = 50.0;
    int rods = 8;
};

scene::Scene scene_of(const Keys& k, const char* field = "auto") {
    std::string text = fmt::format("schema = 1\n[medium]\neta = 1.0\nxi = 1.0\nfield = "
                                   "\"{}\"\n{}{}[coupling]\n{}[rods_run]\nt_end = {}\n{}",
                                   field, k.box, k.table, k.coupling, k.t_end, k.run);
    for (int rod = 0; rod < k.rods; ++rod)
        text += fmt::format("[[rods]]\nposition = [0.0, {}]\nheading = {}\n", 0.2 * rod, rod);
    return scene::parse_scene(text, "auto.toml");
}

FieldChoice choice(const Keys& keys) { return app::field_choice(scene_of(keys)); }

bool says(const FieldChoice& choice, const std::string& part) {
    INFO(choice.why);
    return choice.why.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("in a box a table is chosen where it saves more than it takes to make") {
    const FieldChoice table = choice({});
    CHECK(table.backend == FieldBackend::table);
    CHECK(table.tolerance == 1e-8); // rtol
    CHECK(says(table, "by a table of 1e-08"));
    const scene::Scene chosen = app::with_field(scene_of({}), table);
    CHECK(chosen.medium->field == FieldBackend::table);
    CHECK(chosen.medium->table->tolerance == 1e-8);
    CHECK(choice({.t_end = 1e-3}).backend == FieldBackend::exact);
    CHECK(choice({.table = "table.tolerance = 1e-5\n"}).tolerance == 1e-5);
    CHECK(choice({.run = "rtol = 1e-2\n"}).tolerance == 1e-3); // the coarsest there is
}

TEST_CASE("a longer run never goes back from a table to the exact field") {
    bool by_table = false;
    for (double t_end = 1e-3; t_end < 1e4; t_end *= 2.0) {
        const bool now = choice({.t_end = t_end}).backend == FieldBackend::table;
        CHECK((now || !by_table));
        by_table = now;
    }
    CHECK(by_table);
}

TEST_CASE("the exact field where a table cannot be had or is not asked") {
    CHECK(says(choice({.run = "rtol = 1e-12\n"}), "tables of a box reach 1e-10"));
    CHECK(says(choice({.box = "periodic = 200.0\n"}), "too large"));
    CHECK(says(choice({.coupling = "kappa = 0.0\n"}), "no rod turns"));
    CHECK(says(choice({.box = "", .rods = 1}), "no rod turns"));
    CHECK(says(choice({.box = "", .run = "precision = \"fine\"\n"}), "only the exact field has"));
}

TEST_CASE("on the plane a table takes a very long run of few rods at low accuracy") {
    for (const char* rtol : {"rtol = 1e-2\n", "rtol = 1e-8\n"})
        CHECK(choice({.box = "", .run = rtol, .rods = 2}).backend == FieldBackend::exact);
    CHECK(choice({.box = "", .run = "rtol = 1e-3\n", .t_end = 1e7, .rods = 2}).backend ==
          FieldBackend::table);
    CHECK(choice({.box = "", .run = "rtol = 1e-8\n", .t_end = 1e7, .rods = 2}).backend ==
          FieldBackend::exact);
    CHECK(choice({.box = "", .run = "rtol = 1e-3\n", .t_end = 1e7}).backend == FieldBackend::exact); // batch
}

TEST_CASE("what a scene names is not chosen anew") {
    for (const auto& [name, backend] :
         {std::pair{"exact", FieldBackend::exact}, std::pair{"table", FieldBackend::table}}) {
        const scene::Scene scene = scene_of({}, name);
        const FieldChoice same = app::field_choice(scene);
        CHECK(same.backend == backend);
        CHECK(same.why.empty());
        CHECK(app::with_field(scene, same) == scene);
    }
}
