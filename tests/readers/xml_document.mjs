// As much of the DOM of an XML document as ColladaLoader asks for.
// @ts-check

const ENTITIES = { lt: '<', gt: '>', amp: '&', quot: '"', apos: '\'' };

/** @param {string} text */
const unescaped = (text) => text.replace(/&(#x[\da-fA-F]+|#\d+|\w+);/g, (whole, name) =>
  name[0] !== '#' ? /** @type {Record<string, string>} */ (ENTITIES)[name] ?? whole
    : String.fromCodePoint(name[1] === 'x' ? parseInt(name.slice(2), 16) : parseInt(name.slice(1), 10)));

// What is left out; CDATA; the end of an element; its beginning, with attributes; text.
const PIECES = new RegExp([/<!--[^]*?-->|<\?[^]*?\?>|<!DOCTYPE[^>]*>/, /<!\[CDATA\[([^]*?)\]\]>/, /<\/([^>\s]+)\s*>/,
  /<([^\s/>]+)((?:"[^"]*"|'[^']*'|[^'">])*?)(\/?)>/, /([^<]+)/].map((piece) => piece.source).join('|'), 'g');

class XmlText {
  /** @param {string} text */
  constructor(text) {
    this.nodeType = 3;
    this.nodeName = '#text';
    this.textContent = text;
    /** @type {XmlElement[]} */
    this.childNodes = [];
  }
}

class XmlElement {
  /** @param {string} name @param {Map<string, string>} attributes */
  constructor(name, attributes) {
    this.nodeType = 1;
    this.nodeName = name;
    this.attributes = attributes;
    /** @type {(XmlElement | XmlText)[]} */
    this.childNodes = [];
  }

  /** @param {string} name */
  getAttribute(name) { return this.attributes.get(name) ?? null; }

  /** @param {string} name */
  hasAttribute(name) { return this.attributes.has(name); }

  /** @param {string} name @param {string} value */
  setAttribute(name, value) { this.attributes.set(name, value); }

  /** @returns {string} */
  get textContent() { return this.childNodes.map((child) => child.textContent).join(''); }

  /** @param {string} name @returns {XmlElement[]} */
  getElementsByTagName(name) {
    return this.childNodes.flatMap((child) =>
      (child instanceof XmlElement ? [...(child.nodeName === name ? [child] : []), ...child.getElementsByTagName(name)] : []));
  }
}

/** A stand-in for DOMParser. */
export class XmlParser {
  /** @param {string} text */
  parseFromString(text) {
    const root = new XmlElement('#document', new Map());
    const open = [root];
    for (const [, raw, ends, begins, attributes, closed, words] of text.matchAll(PIECES)) {
      const above = open[open.length - 1];
      if (raw !== undefined || words !== undefined) above.childNodes.push(new XmlText(raw ?? unescaped(words)));
      if (ends !== undefined && open.length > 1) open.pop();
      if (begins === undefined) continue;
      const pairs = [...attributes.matchAll(/([^\s=]+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g)];
      const element = new XmlElement(begins, new Map(pairs.map(([, name, a, b]) => [name, unescaped(a ?? b)])));
      above.childNodes.push(element);
      if (!closed) open.push(element);
    }
    return root;
  }
}
