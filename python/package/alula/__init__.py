"""Flight control of tail-sitters from hover to cruise and back, at any angle of attack.

All of it but `alula.environment` is the library itself, compiled.
"""

from ._alula import *
from ._alula import __all__, __doc__, __version__
