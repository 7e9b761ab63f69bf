"""The commands about scenario files: validate, schema."""

from debrisest.cli.inputs import load_all
from debrisest.cli.options import Configs, Settings


def validate(configs: Configs, settings: Settings = None) -> None:
    """Check scenario files and tell every problem with its line."""
    for scenario in load_all(configs, settings):
        estimators = ", ".join(scenario.common.estimators)
        print(f"{scenario.path}: {len(scenario.cases)} cases, estimators: {estimators}")


def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    import json

    from debrisest.scenario.schema import ScenarioFile, scenario_model

    print(json.dumps(scenario_model(ScenarioFile).model_json_schema(), indent=1))
