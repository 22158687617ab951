"""Every finding is as the published schema says."""

import json

import jsonschema
import pytest

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


@pytest.mark.parametrize("fault", range(1, 13))
def test_findings_of_every_fault(nominal_model: NominalModel, fault: int) -> None:
    validator = jsonschema.Draft202012Validator(finding_schema())
    monitor = nominal_model.monitor()
    lines = monitor.observe(simulated(seed=2, fault=fault)).json_lines()
    lines += monitor.finish().json_lines()
    assert lines
    for line in lines:
        validator.validate(json.loads(line))
        assert tuple(json.loads(line)) == KEYS


def test_the_schema_rejects() -> None:
    validator = jsonschema.Draft202012Validator(finding_schema())
    assert not validator.is_valid({})
    assert not validator.is_valid({"id": "a", "unknown": 1})
