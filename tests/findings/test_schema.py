"""Every finding is as the published schema says."""

import json

import jsonschema

from runglight import finding_schema
from runglight.findings.finding import Finding
from runglight.findings.schema import KEYS, SEVERITIES
from runglight.model import NominalModel
from tests.conftest import simulated


def test_the_schema_is_a_schema() -> None:
    schema = finding_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    assert tuple(schema["required"]) == tuple(schema["properties"]) == KEYS
    assert tuple(schema["properties"]["severity"]["enum"]) == SEVERITIES
    assert schema["additionalProperties"] is False


def test_the_decoded_finding_has_the_same_keys() -> None:
    names = {"from_state": "from", "to_state": "to"}
    fields = {names.get(name, name) for name in Finding.__struct_fields__}
    assert fields == set(KEYS)


def test_findings_of_every_fault(nominal_model: NominalModel) -> None:
    validator = jsonschema.Draft202012Validator(finding_schema())
    checked = 0
    for fault in range(1, 13):
        monitor = nominal_model.monitor()
        lines = monitor.observe(simulated(seed=2, fault=fault)).json_lines()
        for line in lines + monitor.finish().json_lines():
            validator.validate(json.loads(line))
            assert tuple(json.loads(line)) == KEYS
            checked += 1
    assert checked > 12


def test_the_schema_rejects() -> None:
    validator = jsonschema.Draft202012Validator(finding_schema())
    assert not validator.is_valid({})
    assert not validator.is_valid({"id": "a", "unknown": 1})
