"""What Mitsuba says while it loads a scene, above all which properties it does not know and drops."""
import re

_LOST = re.compile(r'Found \d+ unreferenced .* in (\w+) plugin of type "([^"]+)":(.*)', re.DOTALL)
_UNUSED = re.compile(r"Found unused parameters:(.*)", re.DOTALL)
_ITEM = re.compile(r'- (?:\w+ )?"([^"]+)"')
_LINE = re.compile(r"\(.*?line (\d+)")
ABOUT_MEDIA = ("medium", "volume", "phase")


class Loss:
    """properties: names that the plugin of this kind (bsdf, medium, ...) does not take."""

    def __init__(self, kind, plugin, properties, line=None):
        self.kind, self.plugin, self.properties, self.line = kind, plugin, properties, line
        self.of_a_medium = kind in ABOUT_MEDIA

    def __str__(self):
        at = ", line %s" % self.line if self.line else ""
        return "%s %s does not know %s%s" % (self.kind, self.plugin, ", ".join(self.properties), at)


class Heard:
    """losses: [Loss]; unused: names given with -D that the scene does not ask for; other: first lines of the rest."""

    def __init__(self):
        self.losses, self.unused, self.other = [], [], []

    def hear(self, text):
        lost, unused = _LOST.search(text), _UNUSED.search(text)
        if lost:
            line = None if "loading string" in text else _LINE.search(text)   # a string is a rewritten file: other lines
            self.losses.append(Loss(lost[1], lost[2], _ITEM.findall(lost[3]), line and line[1]))
        elif unused:
            self.unused += re.findall(r"\$([^=\s]+)=", unused[1])
        else:
            self.other.append(re.sub(r"^.*?\[\S+\]\s*", "", text.strip().split("\n")[0]))


def listen(mi, call):
    """(value of call(), Heard): what was said at level Warn while it ran, instead of on the terminal."""
    heard = Heard()

    class Listener(mi.Appender):
        def append(self, level, text):
            heard.hear(text)

        def log_progress(self, *ignored):
            pass

    logger, before = mi.logger(), mi.log_level()
    known = [logger.appender(i) for i in range(logger.appender_count())]
    listener = Listener()
    logger.clear_appenders()
    logger.add_appender(listener)
    mi.set_log_level(mi.LogLevel.Warn)
    try:
        return call(), heard
    finally:
        mi.set_log_level(before)
        logger.clear_appenders()
        for appender in known:
            logger.add_appender(appender)
