# SPDX-License-Identifier: Apache-2.0
"""The one exception of the package."""


class Error(Exception):
    """An error of sextant, with the message that the program prints.

    code: its kind, such as "too_few_pairs", "degenerate" or "no_consensus". A solver of your own
    raises it to refuse a problem.
    """

    def __init__(self, message: str, code: str = "invalid_input"):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return type(self), (str(self), self.code)
