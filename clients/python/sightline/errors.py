"""What can go wrong, by whose fault it is."""


class SightlineError(Exception):
    """Of all errors that this package raises on purpose."""


class ProtocolError(SightlineError):
    """Bytes of the peer that are no message, or a message that must not be. Never the caller's fault."""


class InputError(SightlineError, ValueError):
    """An argument that cannot be: names it and says what it must be."""


class Refused(SightlineError):
    """The daemon said no, and trying again will not help; the text says why."""


class Timeout(SightlineError):
    """No answer within the time that the caller gave."""
