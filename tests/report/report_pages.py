"""Report pages, read."""

import re
from html.parser import HTMLParser

VOID = {"meta", "wbr", "br"}


class Page(HTMLParser):
    """The text of a page, its attributes, and whether every tag is closed in its turn."""

    def __init__(self, page):
        super().__init__()
        self.open, self.words, self.attributes, self.tags = [], [], [], []
        self.feed(page)
        assert self.open == []
        self.text = re.sub(r"\s+", " ", "".join(self.words))

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.attributes += attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def links(self):
        return [value for name, value in self.attributes if name in ("src", "href") and value]

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)
