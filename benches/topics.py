"""What is measured, in the order of the page."""

from types import ModuleType

from benches import accuracy, budget, clustering, delays, injected_recordings, throughput, triggers

TOPICS: dict[str, ModuleType] = {
    "throughput": throughput,
    "clustering": clustering,
    "accuracy": accuracy,
    "triggers": triggers,
    "delays": delays,
    "budget": budget,
    "recordings": injected_recordings,
}
"""Each has `measure(options) -> results` and `tables(results) -> tables`."""
