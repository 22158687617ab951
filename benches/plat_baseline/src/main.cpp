// plat_baseline: PLAT as published, to be measured beside runglight. See README.md.

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "learn.h"
#include "log.h"
#include "monitor.h"
#include "rules.h"

namespace {

const char* const USAGE =
    "usage: plat_baseline learn LOG.tsv RULES.tsv [--k 5] [--epsilon 20] [--span 3] [--merge 3]\n"
    "                          [--support 0.08]\n"
    "       plat_baseline watch RULES.tsv LOG.tsv [--probing double|linear]\n"
    "                          [--index-probing double|linear] [--device-probing double|linear]\n"
    "                          [--index pointer|sequential] [--repeat N] [--from-file]\n"
    "                          [--stall-after SECONDS] [--check-every CYCLES]\n"
    "                          [--findings FILE] [--snapshot FILE]\n";

struct WrongUse : std::runtime_error {
    explicit WrongUse(const std::string& what) : std::runtime_error(what) {}
};

class Arguments {
  public:
    Arguments(int argc, char** argv) {
        for (int i = 2; i < argc; ++i) {
            const std::string argument = argv[i];
            if (argument.compare(0, 2, "--") != 0) {
                positional_.push_back(argument);
            } else if (argument == "--from-file") {
                options_[argument] = "yes";
            } else if (i + 1 < argc) {
                options_[argument] = argv[++i];
            } else {
                throw WrongUse(argument + " needs a value");
            }
        }
        if (positional_.size() != 2) throw WrongUse("two files are needed");
    }
    const std::string& file(std::size_t i) const { return positional_[i]; }
    std::string take(const std::string& name, const std::string& otherwise) {
        const std::map<std::string, std::string>::iterator found = options_.find(name);
        if (found == options_.end()) return otherwise;
        const std::string value = found->second;
        options_.erase(found);
        return value;
    }
    double number(const std::string& name, double otherwise) {
        const std::string text = take(name, "");
        if (text.empty()) return otherwise;
        char* end = NULL;
        const double value = std::strtod(text.c_str(), &end);
        if (*end || value < 0.0) throw WrongUse(name + " is no number: " + text);
        return value;
    }
    Probing probing(const std::string& name, Probing otherwise) {
        const std::string text = take(name, "");
        if (text.empty()) return otherwise;
        if (text == "double") return DOUBLE_HASHING;
        if (text == "linear") return LINEAR_PROBING;
        throw WrongUse(name + " is double or linear, not " + text);
    }
    void nothing_left() const {
        if (!options_.empty()) throw WrongUse("no such option: " + options_.begin()->first);
    }

  private:
    std::vector<std::string> positional_;
    std::map<std::string, std::string> options_;
};

struct Seconds {
    double wall;
    double cpu;
};

bool less_wall(const Seconds& a, const Seconds& b) { return a.wall < b.wall; }
bool less_cpu(const Seconds& a, const Seconds& b) { return a.cpu < b.cpu; }

class Stopwatch {
  public:
    Stopwatch() : wall_(clock_seconds(CLOCK_MONOTONIC)), cpu_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)) {}
    Seconds passed() const {
        const Seconds seconds = {clock_seconds(CLOCK_MONOTONIC) - wall_,
                                 clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_};
        return seconds;
    }

  private:
    static double clock_seconds(clockid_t clock) {
        timespec now;
        clock_gettime(clock, &now);
        return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) / 1e9;
    }
    double wall_;
    double cpu_;
};

double per_second(std::size_t records, double seconds) {
    return seconds > 0.0 ? static_cast<double>(records) / seconds : 0.0;
}

long peak_rss_bytes() {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * 1024L;
}

int learn_command(Arguments& arguments) {
    Parameters parameters;
    parameters.k = static_cast<std::size_t>(arguments.number("--k", 5));
    parameters.epsilon = arguments.number("--epsilon", parameters.epsilon);
    parameters.span_s = arguments.number("--span", parameters.span_s);
    parameters.merge_s = arguments.number("--merge", parameters.merge_s);
    parameters.support = arguments.number("--support", parameters.support);
    arguments.nothing_left();
    if (parameters.k < 1 || parameters.k > 255 || parameters.epsilon <= 0.0) {
        throw WrongUse("--k lies between 1 and 255, and --epsilon above 0");
    }
    std::vector<Record> records = read_log(arguments.file(0));
    const SymbolList symbols = mark_events(records, NULL);
    const Stopwatch watch;
    const RuleSet rules = learn(records, symbols, parameters);
    const Seconds seconds = watch.passed();
    write_rules(rules, arguments.file(1));
    std::printf(
        "{\"records\": %zu, \"seconds\": %.6f, \"cpu_seconds\": %.6f, "
        "\"records_per_second\": %.0f, \"signals\": %zu, "
        "\"devices\": %zu, \"groups\": %zu, \"rules\": %zu, \"peak_rss_bytes\": %ld}\n",
        records.size(), seconds.wall, seconds.cpu, per_second(records.size(), seconds.wall),
        symbols.size(), rules.devices.size(), rules.groups.size(), rules.rules.size(), peak_rss_bytes());
    return 0;
}

void write_findings(const std::vector<Finding>& findings, const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (!file) throw std::runtime_error("cannot write " + path);
    std::fprintf(file, "record\tkind\tfrom\tto\tobserved\tlimit\n");
    for (std::size_t i = 0; i < findings.size(); ++i) {
        std::fprintf(file, "%zu\t%s\t%s\t%s\t%.9g\t%.9g\n", findings[i].record, findings[i].kind,
                     findings[i].from.c_str(), findings[i].to.c_str(), findings[i].observed,
                     findings[i].limit);
    }
    if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

void write_text(const std::string& text, const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (!file) throw std::runtime_error("cannot write " + path);
    std::fwrite(text.data(), 1, text.size(), file);
    if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

std::size_t count_kind(const std::vector<Finding>& findings, const std::string& kind) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < findings.size(); ++i) count += findings[i].kind == kind;
    return count;
}

void print_probes(const char* table, const ProbeCounts& counts, const char* after) {
    std::printf("\"%s\": {\"queries\": %llu, \"probes\": %llu}%s", table,
                static_cast<unsigned long long>(counts.queries),
                static_cast<unsigned long long>(counts.probes), after);
}

struct WatchOptions {
    std::string rules;
    std::string log;
    std::string findings;
    std::string snapshot;
    std::size_t repeat;
    bool from_file;
    Settings settings;
};

template <class Index>
int watch_with(const WatchOptions& options) {
    const RuleSet rules = read_rules(options.rules);
    const std::set<std::string> words = rules.words();
    const std::uint32_t seed = collision_free_seed(rules);
    std::vector<Record> records;
    std::vector<Seconds> runs;
    std::unique_ptr<Monitor<Index> > monitor;
    for (std::size_t run = 0; run < options.repeat; ++run) {
        Seconds reading_s = {0.0, 0.0};
        if (run == 0 || options.from_file) {
            std::vector<Record>().swap(records);
            const Stopwatch reading;
            records = read_log(options.log);
            if (options.from_file) reading_s = reading.passed();
            mark_events(records, &words);
        }
        monitor.reset(new Monitor<Index>(rules, seed, options.settings));
        const Stopwatch processing;
        for (std::size_t i = 0; i < records.size(); ++i) monitor->process(records[i], i + 1);
        Seconds seconds = processing.passed();
        seconds.wall += reading_s.wall;
        seconds.cpu += reading_s.cpu;
        runs.push_back(seconds);
    }
    std::sort(runs.begin(), runs.end(), less_wall);
    const double median_s = runs[runs.size() / 2].wall;
    const double best_s = runs[0].wall;
    const double best_cpu_s = std::min_element(runs.begin(), runs.end(), less_cpu)->cpu;
    const std::vector<Finding>& findings = monitor->findings();
    if (!options.findings.empty()) write_findings(findings, options.findings);
    if (!options.snapshot.empty()) write_text(monitor->snapshot(), options.snapshot);
    std::printf(
        "{\"records\": %zu, \"seconds\": %.6f, \"best_seconds\": %.6f, \"cpu_seconds\": %.6f, "
        "\"records_per_second\": %.0f, \"unknown\": %zu, \"late\": %zu, \"stalls\": %zu, \"transition_probability\": %zu, "
        "\"time_probability\": %zu, \"average_time\": %zu, \"unknown_devices\": %zu, \"probes\": {",
        records.size(), median_s, best_s, best_cpu_s, per_second(records.size(), median_s),
        count_kind(findings, "transition"), count_kind(findings, "late"),
        count_kind(findings, "stall"), count_kind(findings, "transition_probability"),
        count_kind(findings, "time_probability"), count_kind(findings, "average_time"),
        monitor->unknown_devices);
    print_probes("index", monitor->index_probes, ", ");
    print_probes("device", monitor->device_probes, ", ");
    print_probes("group", monitor->group_probes, "");
    std::printf("}, \"memory_bytes\": %zu, \"peak_rss_bytes\": %ld}\n", monitor->memory_bytes(),
                peak_rss_bytes());
    return 0;
}

int watch_command(Arguments& arguments) {
    WatchOptions options;
    options.rules = arguments.file(0);
    options.log = arguments.file(1);
    const Probing both = arguments.probing("--probing", DOUBLE_HASHING);
    options.settings.index_probing = arguments.probing("--index-probing", both);
    options.settings.device_probing = arguments.probing("--device-probing", both);
    const std::string index = arguments.take("--index", "pointer");
    options.repeat = static_cast<std::size_t>(arguments.number("--repeat", 1));
    options.from_file = !arguments.take("--from-file", "").empty();
    options.settings.stall_after_ns =
        static_cast<std::int64_t>(arguments.number("--stall-after", 180) * 1e9);
    options.settings.check_every = static_cast<unsigned>(arguments.number("--check-every", 30));
    options.findings = arguments.take("--findings", "");
    options.snapshot = arguments.take("--snapshot", "");
    arguments.nothing_left();
    if (options.repeat < 1 || options.settings.check_every < 1) {
        throw WrongUse("--repeat and --check-every must be at least 1");
    }
    if (index == "pointer") return watch_with<PointerIndex>(options);
    if (index == "sequential") return watch_with<SequentialIndex>(options);
    throw WrongUse("--index is pointer or sequential, not " + index);
}

}  // namespace

int main(int argc, char** argv) {
    const std::string command = argc > 1 ? argv[1] : "";
    try {
        if (command != "learn" && command != "watch") throw WrongUse("learn or watch?");
        Arguments arguments(argc, argv);
        return command == "learn" ? learn_command(arguments) : watch_command(arguments);
    } catch (const WrongUse& wrong) {
        std::fprintf(stderr, "plat_baseline: %s\n%s", wrong.what(), USAGE);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "plat_baseline: %s\n", error.what());
    }
    return 2;
}
