#pragma once
// A scan on the ranks of an MPI job: `mpiexec -n N rodwake scan SCENE`. Rank 0 owns the run folder, places
// the points and evaluates some itself; the others evaluate what it hands them. One thread a rank computes,
// so give as many ranks as there are cores. A rank that dies takes the job with it (MPI's way); the ledger
// keeps what was committed, and the same command goes on.

#include "rodwake/scan/point.hpp"

#include <memory>
#include <string>

namespace rodwake::scan {

// Who evaluates the points: threads of this process, or the ranks of an MPI job.

/// Gets results chunk by chunk, in any order, one call at a time.
using Take = std::function<void(std::span<const Result>)>;

/// Evaluates points and hands every result to `take`; false if it was stopped before all were done. Points
/// start in the order given, so dear ones belong first.
using Execute = std::function<bool(std::span<const Point> points, const Take& take)>;

/// On threads of this process. Chunks take about 10 ms by the cost measured so far, so that a kill loses
/// little and the last chunks end together. `stop` is asked between chunks; it may be empty.
Execute on_threads(Evaluate evaluate, std::size_t threads, std::function<bool()> stop);

/// Whether mpiexec, srun or the like made this process one of several ranks, by what they put into its
/// environment.
bool started_as_rank();

class MpiJob {
public:
    /// The job of which this process is a rank; null if it is alone. MPI is touched only in a job. Throws
    /// InputError in a job if this build has no MPI.
    static std::unique_ptr<MpiJob> join();

    MpiJob(const MpiJob&) = delete;
    MpiJob& operator=(const MpiJob&) = delete;
    /// Rank 0 sends the others home first.
    ~MpiJob();

    int rank() const { return rank_; }
    /// Of rank 0. The job must outlive it.
    Execute executor(Evaluate evaluate, std::function<bool()> stop);
    /// Of the others: evaluates chunks until rank 0 has no more.
    void serve(const Evaluate& evaluate);
    /// Of the others: tells rank 0, whose scan ends with this error, and leaves the job.
    void fail(const std::string& why);

private:
    MpiJob();
    struct Workers;

    int rank_ = 0, ranks_ = 1;
    std::unique_ptr<Workers> workers_; ///< of rank 0
};

} // namespace rodwake::scan
