# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Tables of measurements in pages of docs, between lines that say whose they are."""


def put(page, name, text):
    """Puts text between the lines `<!-- name begin -->` and `<!-- name end -->` of a page, which has them."""
    begin, end = f"<!-- {name} begin -->\n", f"<!-- {name} end -->"
    head, rest = page.read_text().split(begin)
    page.write_text(head + begin + text + end + rest.split(end)[1])
