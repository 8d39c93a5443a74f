"""Is a run's result.json what tests/schema/result.schema.json says? validate_result.py RESULT.json...

Exit status 0 if every file is, else 1 with the reasons on standard error. Tests import problems().
"""
import json
import math
import os
import sys

import jsonschema

SCHEMA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "schema", "result.schema.json")


def schema():
    with open(SCHEMA, encoding="utf-8") as file:
        document = json.load(file)
    jsonschema.Draft7Validator.check_schema(document)
    return document


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


def problems(text):
    """What is wrong with the text of a result.json, as a list of sentences."""
    try:
        result = json.loads(text, parse_constant=refuse_constant)  # Python takes NaN, the schema's other readers do not
    except ValueError as error:
        return [str(error)]
    found = [f"{'/'.join(map(str, error.absolute_path)) or 'the document'}: {error.message}"
             for error in jsonschema.Draft7Validator(schema()).iter_errors(result)]
    if not found:
        found = [f"parameters/{name}: quantiles do not rise" for name, parameter in result.get("parameters", {}).items()
                 if not parameter["q05"] <= parameter["q50"] <= parameter["q95"]]
        found += [f"tests/{test['file']}: r = {test['r']}" for test in result.get("tests", [])
                  if test["r"] is not None and not (math.isfinite(test["r"]) and abs(test["r"]) <= 1)]
    return found


def main(paths):
    status = 0
    for path in paths:
        with open(path, encoding="utf-8") as file:
            for problem in problems(file.read()):
                print(f"{path}: {problem}", file=sys.stderr)
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
