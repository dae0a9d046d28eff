#pragma once
// Starts of a fit that are done, one record each, so that an interrupted fit goes on with the others.

#include "rodwake/fitting/method.hpp"
#include "rodwake/store/append_log.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace rodwake::app {

class FitLedger {
public:
    /// `key`: everything the ends depend on; records of another key are dropped. `free`: number of free
    /// parameters.
    FitLedger(std::filesystem::path file, const std::string& key, std::size_t free);

    const std::vector<fitting::StartResult>& done() const { return done_; }
    /// In the file before it returns: what is killed afterwards keeps it.
    void add(const fitting::StartResult& end);
    void remove();

private:
    std::filesystem::path file_;
    std::uint64_t key_;
    std::size_t free_;
    std::vector<fitting::StartResult> done_;
    std::unique_ptr<store::AppendLog> log_;
};

} // namespace rodwake::app
