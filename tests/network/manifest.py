#!/usr/bin/python3
"""manifest.py MANIFEST PROGRAMS: prints the faults of a Kubernetes manifest that the programs' help reveals."""
import os
import re
import subprocess
import sys

import yaml

manifest, programs = sys.argv[1:]
with open(manifest, encoding="utf-8") as file:
    items = yaml.safe_load(file)["items"]
names = {item["metadata"]["name"] for item in items if item["kind"] == "Service"}
for item in items:
    if item["kind"] not in ("StatefulSet", "Job"):
        continue
    template = item["spec"]["template"]
    app = template["metadata"]["labels"]["app"]
    pod = template["spec"]
    volumes = {volume["name"] for volume in pod["volumes"] + [
        {"name": claim["metadata"]["name"]} for claim in item["spec"].get("volumeClaimTemplates", [])]}
    if item["kind"] == "StatefulSet" and item["spec"]["selector"]["matchLabels"]["app"] != app:
        print(f"{app}: its pods are not those that it selects")
    for container in pod["containers"]:
        mounts = {mount["name"]: mount["mountPath"] for mount in container["volumeMounts"]}
        for volume in set(mounts) - volumes:
            print(f"{app}: there is no volume {volume}")
        words = " ".join(container["args"]).split()
        program = next(word for word in words if os.path.exists(os.path.join(programs, word)))
        command = [os.path.join(programs, program)] + (words[1:2] if program == "coppice" else [])
        known = subprocess.run(command + ["--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        for option in re.findall(r"(?<=\s)--[a-z-]+", " ".join(words)):
            if not re.search(rf"{option}\b", known):
                print(f"{app}: {program} has no option {option}")
        for path in re.findall(r"(?<=\s)/[a-z/.0-9-]+", " ".join(words)):
            if not any(path.startswith(mount) for mount in mounts.values()):
                print(f"{app}: {path} is on no volume")
        for variable in container.get("env", []):
            if variable["value"].split(":")[0] not in names:
                print(f"{app}: {variable['name']} names no service: {variable['value']}")
