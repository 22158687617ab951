// Building the model (Ghosh 2016, section 2.4).
#ifndef LEARN_H
#define LEARN_H

#include <vector>

#include "log.h"
#include "rules.h"
#include "time_clusters.h"

RuleSet learn(const std::vector<Record>& records, const SymbolList& symbols,
              const Parameters& parameters);

#endif
