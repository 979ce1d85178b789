"""`spool view` as a process, and what it answers."""

import http.client
import json
import os
import signal
import struct
import subprocess
from urllib.parse import urlsplit

import numpy as np
import pytest

ASSETS = os.environ.get("SPOOL_REPORT_ASSETS", os.path.expanduser("~/.cache/spool/report-assets"))
needs_assets = pytest.mark.skipif(not os.path.exists(os.path.join(ASSETS, "plotly-basic.min.js")),
                                  reason="SKIPPED: tools/report/fetch_assets.sh has not been run")


def small_scene(folder):
    path = folder / "s.spool"
    subprocess.run([os.environ["SPOOL_PROGRAM"], "synth", "scene_s", "--size", "24x16", "--samples", "32", "--seed", "3", "-q",
                    "-o", str(path)], check=True)
    return path


class Served:
    def __init__(self, *words):
        self.process = subprocess.Popen([os.environ["SPOOL_PROGRAM"], "view", "--json", *map(str, words)], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        assert line, self.process.stderr.read()
        self.url = json.loads(line)["url"]
        self.host, self.port = urlsplit(self.url).hostname, urlsplit(self.url).port
        self.root = urlsplit(self.url).path

    def ask(self, path, method="GET", headers=None, body=None):
        connection = http.client.HTTPConnection(self.host, self.port, timeout=120)
        connection.request(method, path, body=body, headers=headers or {})
        answer = connection.getresponse()
        answer.content = answer.read()
        connection.close()
        return answer

    def json(self, name):
        answer = self.ask(self.root + name)
        assert answer.status == 200, answer.content
        return json.loads(answer.content)

    def planes(self, name):
        answer = self.ask(self.root + name)
        assert answer.status == 200, answer.content
        length, = struct.unpack("<I", answer.content[:4])
        said, at, planes = json.loads(answer.content[4:4 + length]), 4 + length, {}
        for plane in said["planes"]:
            size = said["width"] * said["height"] * plane["channels"]
            values = np.frombuffer(answer.content, "<f4", size, at)
            planes[plane["name"]] = values.reshape(said["height"], said["width"], plane["channels"])
            at += 4 * size
        assert at == len(answer.content)
        return said, planes

    def key(self, sampler, filter_, spp, recording=0):
        choices = self.json("choices")
        return (f"recording={recording}&sampler={choices['samplers'].index(sampler)}"
                f"&filter={choices['filters'].index(filter_)}&spp={spp}")

    def end(self, how=signal.SIGINT):
        self.process.send_signal(how)
        _, said = self.process.communicate(timeout=20)
        return self.process.returncode, said
