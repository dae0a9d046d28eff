#pragma once
// Scenes with a scan, and what becomes of them.

#include "rodwake/app/plan.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>

namespace app_test {

using namespace rodwake;
using store_test::error_of;
using store_test::has;

inline const std::string pair_text = R"(schema = 1
[scales]
f_over_mu = "2.0 a"
v0 = "2.0 mm/s"
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 0.5
[rods_run]
t_end = 30.0
output_interval = 1.0
contact_distance = 0.1
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
)";

inline std::string axis(const std::string& lines) { return "[[scan.axes]]\n" + lines + "\n"; }

inline const std::string kappa =
    axis("key = \"coupling.kappa\"\nfrom = 0.1\nto = 100.0\nspacing = \"log\"\ncount = 4");

inline scene::Scene read(const std::string& scan, const std::string& text = pair_text) {
    return scene::parse_scene(text + "[scan]\n" + scan, "scene.toml");
}

inline app::ScanPlan plan(const std::string& scan, const std::string& text = pair_text) {
    return app::plan_scan(read(scan, text), std::nullopt);
}

inline std::string refusal(const std::string& scan, const std::string& text = pair_text) {
    return error_of<InputError>([&] { plan(scan, text); });
}

inline scene::Scene overridden(const std::string& text, const std::string& setting) {
    const std::vector<std::string> settings = {setting};
    return scene::parse_scene(text, "scene.toml", settings);
}

/// The scene at these values of the axes.
inline scene::Scene at(const app::ScanPlan& plan, std::vector<double> values) {
    scene::Scene scene = plan.base;
    scan::Point point;
    std::ranges::copy(values, point.at.begin());
    const auto wrong = app::set_point(plan, scene, point);
    INFO(wrong.value_or(""));
    REQUIRE_FALSE(wrong);
    return scene;
}

/// Plan of a list with these columns.
inline app::ScanPlan list(const app::ScanList& rows) {
    return app::plan_scan(read("design = \"list\"\nfile = \"points.csv\"\n"), rows);
}

inline std::string list_refusal(const app::ScanList& rows) {
    return error_of<InputError>([&] { list(rows); });
}

} // namespace app_test
