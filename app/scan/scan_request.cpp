#include "scan_parts.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scan/run.hpp"
#include "rodwake/store/csv.hpp"

#include <algorithm>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

void require_ledger(const fs::path& file, const ScanPlan& plan) {
    if (!fs::exists(file))
        throw InputError(file.string() + ": no such ledger");
    scan::require_ledger(file, ledger_head(plan));
}

} // namespace

scan::LedgerHead ledger_head(const ScanPlan& plan) {
    scan::Axis row;
    row.name = "row";
    return {plan.description, is_long_list(plan.design) ? std::vector{row} : plan.design.axes, plan.columns};
}

std::vector<fs::path> shares_in(const fs::path& folder) {
    std::vector<fs::path> shares;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
        if (entry.path().filename().string().starts_with("part-") && entry.is_directory())
            shares.push_back(entry.path() / scan::ledger_file);
    std::ranges::sort(shares);
    return shares;
}

void require_scan(const ScanPlan& plan, const fs::path& folder, const RunContext& context) {
    scan::require_part(plan.design, context.scan.part);
    if (!context.force && fs::exists(folder / "ledger.sqlite"))
        throw InputError((folder / "ledger.sqlite").string() +
                         ": is the ledger of a scan of rodwake 0.3, which cannot be resumed; choose another "
                         "folder with -o, or --force to start anew");
    if (!context.force && fs::exists(folder / scan::ledger_file))
        require_ledger(folder / scan::ledger_file, plan);
    if (!context.scan.merge)
        return;
    const std::vector<fs::path> shares = shares_in(folder);
    if (shares.empty())
        throw InputError(folder.string() +
                         ": holds no shares (part-1-of-n, ...) to merge; rodwake scan SCENE --part i/n makes "
                         "them");
    for (const fs::path& share : shares)
        require_ledger(share, plan);
}

std::optional<ScanList> read_scan_list(const scene::Scene& scene) {
    if (!scene.scan || scene.scan->file.empty())
        return std::nullopt;
    const fs::path name = scene.scan->file, beside = fs::path(scene.path).parent_path() / name;
    if (!fs::exists(beside) && !fs::exists(name))
        throw InputError(scene.path + ": scan.file = \"" + name.string() +
                         "\": no such file, neither in the folder of the scene nor in the working folder");
    const fs::path path = fs::exists(beside) ? beside : name;
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
