#pragma once
// Rows for the tests of ledgers.

#include "maps.hpp"

namespace scan_test {

inline LedgerHead ledger_head() {
    Axis words = axis("rods_run.method", 0.0, 2.0, 3);
    words.spacing = Spacing::listed;
    words.words = {"bdf", "adams", "it's \"erk\""};
    words.values = {0.0, 1.0, 2.0};
    return {"a scan", {axis("coupling.kappa", -1.0, 1.0, 5), words}, columns};
}

inline Result succeeded(std::int64_t id, double kappa, double word = 0.0) {
    Result r;
    r.point = {id, {kappa, word}};
    r.outcome = 1;
    r.values = {0.1, 0.0};
    r.seconds = 1e-4;
    return r;
}

inline Result failed(std::int64_t id, Status status = Status::failed, const char* cause = "too many steps") {
    Result r = succeeded(id, 0.5);
    r.status = status;
    r.outcome = -1;
    r.retries = 3;
    r.set_cause(cause);
    return r;
}

} // namespace scan_test
