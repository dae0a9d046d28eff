#include "fit_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/bytes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace rodwake::app {

namespace {

using fitting::ChainBlock;

/// Blocks that are done, as FitLedger keeps starts.
class BlockLedger {
public:
    BlockLedger(std::filesystem::path file, const std::string& key, std::size_t free)
        : file_(std::move(file)), key_(std::hash<std::string>{}(key)), free_(free),
          bytes_(8 * (10 + fitting::most_numbers_of_block(free))) {
        try {
            read();
        } catch (const InputError&) { // a damaged one is of no use, and no harm: what was read so far holds
        }
        if (done_.empty())
            std::filesystem::remove(file_);
        log_ = std::make_unique<store::AppendLog>(file_, bytes_, done_.size());
    }

    const std::vector<ChainBlock>& done() const { return done_; }

    void add(const ChainBlock& block) {
        store::ByteWriter out;
        out.put(key_);
        out.put(std::uint64_t{block.chain});
        out.put(std::uint64_t{block.index});
        for (const double one : {block.log_density, block.log_scale, block.accepted})
            out.put(one);
        for (const auto* list : {&block.z, &block.kept, &block.kept_density})
            out.put_array(*list);
        std::vector<std::byte> record = out.take();
        record.resize(bytes_);
        log_->append(record);
        log_->flush();
    }

private:
    void read() {
        constexpr std::size_t header = 32, check = 8; // of store::AppendLog
        std::error_code error;
        const auto size = std::filesystem::file_size(file_, error);
        const std::size_t count = error || size < header ? 0 : (size - header) / (bytes_ + check);
        if (count == 0)
            return;
        store::AppendLog log(file_, bytes_, count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::vector<std::byte> record = log.read(i);
            store::ByteReader in(record, file_.string());
            if (in.get<std::uint64_t>() != key_)
                return done_.clear();
            ChainBlock block;
            block.chain = in.get<std::uint64_t>();
            block.index = in.get<std::uint64_t>();
            for (double* one : {&block.log_density, &block.log_scale, &block.accepted})
                *one = in.get<double>();
            for (auto* list : {&block.z, &block.kept, &block.kept_density})
                *list = in.get_array<double>();
            const std::size_t kept = block.kept_density.size();
            if (block.z.size() != free_ || block.kept.size() % std::max<std::size_t>(free_, 1) != 0 ||
                (kept > 0 && block.kept.size() != kept * free_))
                throw InputError(file_.string() + ": is damaged");
            done_.push_back(std::move(block));
        }
    }

    std::filesystem::path file_;
    std::uint64_t key_;
    std::size_t free_, bytes_;
    std::vector<ChainBlock> done_;
    std::unique_ptr<store::AppendLog> log_;
};

fitting::Prior prior_of(const FitPlan& plan, const fitting::Parameter& p) {
    double low = p.lower, high = p.upper;
    if (fitting::is_start_pose(p.name)) { // "x.<track>.<rod>"
        const fitting::Trajectory& track =
            plan.tracks.at(std::stoul(p.name.substr(p.name.find('.') + 1))).data;
        const double sigma = p.name.starts_with("heading") ? track.sigma_heading : track.sigma_position,
                     wide = 10.0 * sigma / std::sqrt(track.independent);
        low = p.start - wide, high = p.start + wide;
    }
    const auto& priors = plan.keys.posterior->priors;
    fitting::Prior prior = priors.contains(p.name) ? priors.at(p.name) : fitting::Prior{};
    prior.low = prior.low.value_or(low), prior.high = prior.high.value_or(high);
    return prior;
}

void log_posterior(const FitPlan& plan, const fitting::Posterior& found, const Logger& log) {
    for (std::size_t k = 0; k < found.free.size(); ++k) {
        const fitting::Marginal& m = found.marginals[k];
        log->info("posterior: {} = {:.6g} +- {:.2g}, 95 % within {:.5g} and {:.5g}; R-hat {:.4f}, {:.0f} "
                  "effective samples",
                  plan.problem.parameters[found.free[k]].name, m.mean, m.sd, m.q025, m.q975, m.rhat, m.ess);
    }
    if (found.log_evidence)
        log->info("posterior: log evidence {:.3f} +- {:.2g}", found.log_evidence->value,
                  found.log_evidence->error);
    for (const std::string& remark : found.remarks)
        log->warn("posterior: {}", remark);
}

} // namespace

std::vector<fitting::Prior> fit_priors(const FitPlan& plan) {
    std::vector<fitting::Prior> priors;
    for (const std::size_t i : fitting::free_parameters(plan.problem))
        priors.push_back(prior_of(plan, plan.problem.parameters[i]));
    return priors;
}

fitting::PosteriorMethod posterior_method(const FitPlan& plan) {
    const scene::FitPosterior& keys = *plan.keys.posterior;
    fitting::PosteriorMethod method;
    method.chains = keys.chains, method.samples = keys.samples, method.evidence = keys.evidence;
    method.seed = plan.method.seed;
    return method;
}

bool add_posterior(const FitPlan& plan, const fitting::Fit& fit, const std::string& key,
                   const RunContext& context, const std::filesystem::path& folder, const Logger& log) {
    if (!plan.keys.posterior)
        return true;
    const std::vector<fitting::Prior> priors = fit_priors(plan);
    BlockLedger ledger(folder / posterior_ledger_file, key, priors.size());
    fitting::PosteriorMethod method = posterior_method(plan);
    method.threads = context.thread_count();
    method.done = ledger.done();
    std::size_t count = method.done.size();
    if (count > 0)
        log->info("posterior: going on after {} of {} blocks", count, fitting::block_count(method));
    Progress progress(context, "posterior", static_cast<double>(fitting::block_count(method)), "blocks");
    method.on_block_done = [&](const ChainBlock& block) {
        ledger.add(block);
        progress.update(static_cast<double>(++count));
    };
    method.stop_requested = [&] { return context.stopped(); };
    const auto found = fitting::sample(plan.problem, priors, fit.values, method);
    if (!found)
        return false;
    write_posterior(folder, plan, *found, context);
    log_posterior(plan, *found, log);
    return true;
}

} // namespace rodwake::app
