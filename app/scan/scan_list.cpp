#include "scan_list.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/csv.hpp"

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

fs::path find_file(const scene::Scene& scene) {
    fs::path name = scene.scan->file, beside = fs::path(scene.path).parent_path() / name;
    if (fs::exists(beside))
        return beside;
    if (fs::exists(name))
        return name;
    throw InputError(scene.path + ": scan.file = \"" + name.string() +
                     "\": no such file, neither beside the scene nor here");
}

} // namespace

std::optional<ScanList> read_scan_list(const scene::Scene& scene) {
    if (!scene.scan || scene.scan->design != scene::ScanDesign::list)
        return std::nullopt;
    const fs::path path = find_file(scene);
    ScanList list;
    list.keys = store::csv_names(path);
    const store::Table table = store::read_csv(path, list.keys);
    list.rows.assign(table.rows(), std::vector<double>(list.keys.size()));
    for (std::size_t k = 0; k < list.keys.size(); ++k) {
        const std::vector<double>& column = *table.find(list.keys[k]);
        for (std::size_t i = 0; i < column.size(); ++i)
            list.rows[i][k] = column[i];
    }
    return list;
}

} // namespace rodwake::app
