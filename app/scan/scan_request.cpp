#include "scan_request.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scan/run.hpp"

#include <algorithm>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

void require_ledger(const fs::path& file, const ScanPlan& plan) {
    if (!fs::exists(file))
        throw InputError(file.string() + ": no such ledger");
    const scan::Ledger opened(file, ledger_head(plan));
}

} // namespace

scan::LedgerHead ledger_head(const ScanPlan& plan) {
    scan::Axis row;
    row.name = "row";
    return {plan.description, is_long_list(plan.design) ? std::vector{row} : plan.design.axes, plan.columns,
            plan.design.runs > 0};
}

std::vector<fs::path> shares_in(const fs::path& folder) {
    std::vector<fs::path> shares;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
        if (entry.path().filename().string().starts_with("part-") && entry.is_directory())
            shares.push_back(entry.path() / "ledger.sqlite");
    std::ranges::sort(shares);
    return shares;
}

void require_scan(const ScanPlan& plan, const fs::path& folder, const RunContext& context) {
    scan::require_part(plan.design, context.scan.part);
    if (!context.force && fs::exists(folder / "ledger.sqlite"))
        require_ledger(folder / "ledger.sqlite", plan);
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

} // namespace rodwake::app
