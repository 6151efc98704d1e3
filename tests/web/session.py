"""A live session of its own for a test: started on free ports, ended, with its summary."""
import json
import os
import re
import subprocess
import tempfile


class LiveSession:
    def __init__(self, app, scene, *options):
        self.folder = tempfile.mkdtemp(prefix="seldinger-live-")
        self.record = os.path.join(self.folder, "session.record")
        self.process = subprocess.Popen([app, "live", scene, "--port", "0", "--udp", "0", "--record", self.record, *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"page http://[^:]+:(\d+)/(\S*) +hand UDP [^:]+:(\d+)", line)
        if not found:
            raise RuntimeError("no session: " + line + self.process.stderr.read())
        self.port, self.query, self.udp = int(found.group(1)), found.group(2), int(found.group(3))

    @property
    def url(self):
        return f"http://127.0.0.1:{self.port}/{self.query}"

    def end(self):
        """@return summary of the session"""
        if self.process.poll() is None:
            self.process.terminate()
        self.process.communicate(timeout=60)
        with open(self.record + ".summary.json") as file:
            return json.load(file)
