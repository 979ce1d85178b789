"""The page of a recording in the browser: `spool view`, which serves this machine only, until another
page is asked for or Blender ends.

The address holds a token that lets one look. A command line is seen by every user of the machine, so
the browser is handed a file that only its owner can read, which leads to the address.
"""
import atexit
import html
import json
import os
import subprocess
import webbrowser

import bpy

server = None


def open_page(program, file):
    """Starts the program on the file and the browser on its page. Returns an error."""
    global server
    close()
    try:
        server = subprocess.Popen([program, "view", file, "--json", "-q"], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except OSError as error:
        return "%s: %s" % (program, error.strerror)
    said = server.stdout.readline()        # one line as soon as it serves; none when it ends
    if not said:
        reason = server.stderr.read().strip().splitlines()
        close()
        return reason[-1] if reason else "%s view ended without a word" % program
    if not webbrowser.open("file://" + _leading_to(json.loads(said)["url"])):
        close()
        return "no browser was found"
    return ""


def close():
    global server
    if server is not None:
        server.terminate()
        server.wait()
    server = None


def _leading_to(url):
    path = os.path.join(bpy.app.tempdir, "spool_view.html")
    if os.path.exists(path):
        os.remove(path)
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as stream:
        stream.write('<meta http-equiv="refresh" content="0;url=%s">' % html.escape(url))
    return path


atexit.register(close)
