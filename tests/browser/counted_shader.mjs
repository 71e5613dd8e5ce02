// Twins of shaders that count their own operations while they run. Each operator and each built-in function counts once for every
// component, in the block where it stands: a function, a loop's body, a branch, an operand of ?: or && that may be left out. Four numbers
// are counted: operations of floats, operations of integers and truth values, special functions, and fetches from textures. Copies,
// indices, swizzles, choices and operations of literals alone are free.
import { generate, parser } from '@shaderfrog/glsl-parser/index.js';

// Plain and special operations per component of the largest argument. 'pow' is a logarithm, a product and a power of 2, for example.
const PER_COMPONENT = {
  abs: [1, 0], all: [1, 0], any: [1, 0], atan: [10, 1], ceil: [1, 0], clamp: [2, 0], cos: [1, 1], exp: [1, 1],
  floatBitsToUint: [0, 0], floor: [1, 0], fract: [1, 0],
  greaterThan: [1, 0], lessThan: [1, 0], max: [1, 0], min: [1, 0], mix: [3, 0], pow: [1, 2], radians: [1, 0],
  sin: [1, 1], smoothstep: [9, 1], sqrt: [0, 1], uintBitsToFloat: [0, 0],
};
// The same of vectors with n components.
const PER_VECTOR = { cross: () => [9, 0], dot: n => [2 * n - 1, 0], length: n => [2 * n - 1, 1], normalize: n => [3 * n - 1, 1] };
// The types of results that are not the largest argument's.
const RESULTS = { all: 'bool', any: 'bool', dot: 'float', length: 'float', floatBitsToUint: 'uint', uintBitsToFloat: 'float' };
const VARIABLES = [['gl_FragCoord', 'vec4'], ['gl_FrontFacing', 'bool'], ['gl_Position', 'vec4'], ['gl_VertexID', 'int']];
const VALUE_TYPE = /^(float|u?int|bool|[iub]?vec[234]|mat[234])$/;

const sizeOf = type => Number(/vec(\d)$/.exec(type)?.[1] ?? 1);
const baseOf = type => /^(bool|bvec)/.test(type) ? 'bool' : /^(int|ivec)/.test(type) ? 'int' : /^(uint|uvec)/.test(type) ? 'uint' : 'float';
const vectorOf = (base, size) => size === 1 ? base : `${{ float: '', int: 'i', uint: 'u', bool: 'b' }[base]}vec${size}`;
const typeName = specifier => specifier.identifier ?? specifier.token;
const none = () => [0, 0, 0, 0];

// A walk through a shader's files, in their order. `sum`: the operations of the block so far.
class Counting {
  constructor() { Object.assign(this, { scopes: [new Map(VARIABLES)], functions: new Map(), structs: new Map(), sum: none() }); }

  add(type, plain, special = 0) {
    this.sum[baseOf(type) === 'float' ? 0 : 1] += plain;
    this.sum[2] += special;
  }

  inScope(work) {
    this.scopes.push(new Map());
    const result = work();
    this.scopes.pop();
    return result;
  }

  // What work() adds to the sum, and its result, without a change of the sum.
  apart(work) {
    const before = this.sum;
    this.sum = none();
    const result = work(), sum = this.sum;
    this.sum = before;
    return { sum, result };
  }

  // --- Expressions: each is { type, literal } ---

  expression(node) {
    if (node.type.endsWith('_constant')) return { type: node.type.replace('_constant', ''), literal: true };
    switch (node.type) {
      case 'identifier': return { type: this.variable(node.identifier) };
      case 'group': return this.expression(node.expression);
      case 'unary': return this.unary(this.expression(node.expression));
      case 'binary': {
        const left = this.expression(node.left), operator = node.operator.literal;
        return this.binary(operator, left,
          operator === '&&' || operator === '||' ? this.perhaps(node, 'right') : this.expression(node.right));
      }
      case 'ternary':
        this.expression(node.expression);
        this.perhaps(node, 'left');
        return this.perhaps(node, 'right');
      case 'assignment': {
        const left = this.expression(node.left), right = this.expression(node.right), operator = node.operator.literal;
        if (operator !== '=') this.binary(operator.slice(0, -1), left, right);
        return left;
      }
      case 'postfix': return this.postfix(node);
      case 'function_call': return this.call(node);
      default: throw new Error(`no count of ${node.type}`);
    }
  }

  variable(name) {
    const type = this.scopes.findLast(scope => scope.has(name))?.get(name);
    if (!type) throw new Error(`no variable ${name}`);
    return type;
  }

  unary(of) {
    if (!of.literal) this.add(of.type, sizeOf(of.type));
    return of;
  }

  binary(operator, left, right) {
    const larger = sizeOf(left.type) >= sizeOf(right.type) ? left : right, size = sizeOf(larger.type);
    const literal = left.literal && right.literal;
    if ([left, right].some(({ type }) => type.startsWith('mat'))) {
      if (operator !== '*' || size === 1) throw new Error(`no count of ${left.type} ${operator} ${right.type}`);
      this.add('float', size * (2 * size - 1));
    } else if (!literal) {
      this.add(larger.type, size, operator === '/' || operator === '%' ? size : 0);  // a division is a product with a reciprocal
    }
    return { type: /^([<>]=?|[=!]=|&&|\|\|)$/.test(operator) ? 'bool' : larger.type, literal };
  }

  // An operand that may be left out counts itself.
  perhaps(parent, key) {
    const { sum, result } = this.apart(() => this.expression(parent[key]));
    if (sum.some(Boolean)) parent[key] = [`(counted_(uvec4(${sum})), `, parent[key], ')'];
    return result;
  }

  postfix(node) {
    let type = this.expression(node.expression).type;
    for (let rest = node.postfix; rest; rest = rest.postfix) {
      const part = rest.type === 'postfix' ? rest.expression : rest;
      if (part.type === 'literal') {
        this.unary({ type });
      } else if (part.type === 'quantifier') {
        this.expression(part.expression);
        type = type.endsWith('[]') ? type.slice(0, -2) : type.replace(/^mat/, 'vec') === type ? baseOf(type) : type.replace(/^mat/, 'vec');
      } else {
        const name = part.selection.identifier;
        type = this.structs.get(type)?.get(name) ?? vectorOf(baseOf(type), name.length);
      }
    }
    return { type };
  }

  call({ identifier, args }) {
    const name = identifier.type === 'identifier' ? identifier.identifier : typeName(identifier.specifier);
    const given = args.filter(({ type }) => type !== 'literal').map(arg => this.expression(arg)), literal = given.every(arg => arg.literal);
    if (this.functions.has(name)) return { type: this.functions.get(name) };
    if (this.structs.has(name)) return { type: name };
    if (VALUE_TYPE.test(name)) return { type: this.converted(name, given), literal };
    if (name === 'texelFetch') {
      this.sum[3] += 1;
      return { type: 'vec4' };
    }
    if (name === 'textureSize') return { type: given[0].type === 'sampler2DArray' ? 'ivec3' : 'ivec2' };
    return this.builtIn(name, given, literal);
  }

  converted(name, given) {
    for (const { literal, type } of given)
      if (!literal && baseOf(type) !== baseOf(name)) this.add('int', Math.min(sizeOf(type), sizeOf(name)));
    return name;
  }

  builtIn(name, given, literal) {
    const size = Math.max(...given.map(({ type }) => sizeOf(type))), largest = given.find(({ type }) => sizeOf(type) === size).type;
    if (!PER_COMPONENT[name] && !PER_VECTOR[name]) throw new Error(`no count of ${name}`);
    if (!literal) this.add(largest, ...(PER_VECTOR[name]?.(size) ?? PER_COMPONENT[name].map(count => count * size)));
    return { type: RESULTS[name] ?? (name.endsWith('Than') ? vectorOf('bool', size) : largest), literal };
  }

  // --- Statements ---

  declare({ specified_type: { specifier: { specifier, quantifier } }, declarations }) {
    for (const { identifier, quantifier: own, initializer } of declarations) {
      if (initializer) this.expression(initializer);
      this.scopes.at(-1).set(identifier.identifier, typeName(specifier) + (quantifier ?? own ? '[]' : ''));
    }
  }

  // The statements of a block with what adds to the counters, before each that may leave the block.
  block(statements) {
    return this.inScope(() => {
      const out = [], count = () => {
        if (this.sum.some(Boolean)) out.push(`counts_ += uvec4(${this.sum});\n`);
        this.sum = none();
      };
      for (const one of statements) {
        const changed = this.statement(one) ?? one;
        if (one.type !== 'declaration_statement' && one.type !== 'expression_statement') count();
        out.push(changed);
      }
      count();
      return out;
    });
  }

  body(node) { return ['{\n', this.apart(() => this.block(node.type === 'compound_statement' ? node.statements : [node])).result, '}\n']; }

  // Adds what runs before anything else of it to the sum. Returns what replaces it, if anything does.
  statement(node) {
    switch (node.type) {
      case 'declaration_statement': this.declare(node.declaration); break;
      case 'expression_statement': this.expression(node.expression); break;
      case 'compound_statement': return this.body(node);
      case 'if_statement':
        this.expression(node.condition);
        node.body = this.body(node.body);
        if (node.else) node.else = ['else ', this.body(node.else[1])];
        break;
      case 'for_statement':
        this.inScope(() => {
          if (node.init.type === 'declarator_list') this.declare(node.init);
          else this.expression(node.init);
          this.perhaps(node, 'condition');
          if (node.operation) this.perhaps(node, 'operation');
          node.body = this.body(node.body);
        });
        break;
      case 'while_statement':
        this.perhaps(node, 'condition');
        node.body = this.body(node.body);
        break;
      case 'return_statement':
        if (node.expression) this.expression(node.expression);
        break;
      case 'break_statement': case 'continue_statement': break;
      default: throw new Error(`no count of ${node.type}`);  // a pixel that is discarded could not say what it cost
    }
    return undefined;
  }

  // --- Files ---

  prototype({ header: { name, returnType }, parameters = [] }) {
    const type = typeName(returnType.specifier.specifier), known = this.functions.get(name.identifier);
    if (known && known !== type) throw new Error(`${name.identifier} has two types`);
    this.functions.set(name.identifier, type);
    for (const { identifier, specifier, quantifier } of parameters)
      if (identifier) this.scopes.at(-1).set(identifier.identifier, typeName(specifier.specifier) + (quantifier ? '[]' : ''));
  }

  struct({ typeName: name, declarations }) {
    const fields = declarations.flatMap(({ declaration: { specified_type: { specifier }, declarations: own } }) =>
      own.map(({ identifier, quantifier }) => [identifier.identifier, typeName(specifier.specifier) + (quantifier ? '[]' : '')]));
    this.structs.set(name.identifier, new Map(fields));
  }

  // The text of a file that counts; what it would write becomes a variable.
  file(tree) {
    for (const one of tree.program) {
      if (one.type === 'function') {
        this.inScope(() => {
          this.prototype(one.prototype);
          one.body.statements = this.block(one.body.statements);
        });
        const { name } = one.prototype.header;
        if (name.identifier === 'main') name.identifier = 'counted_main_';
      } else if (one.declaration?.type === 'function_prototype') {
        this.inScope(() => this.prototype(one.declaration));
      } else if (one.declaration) {
        const type = one.declaration.specified_type;
        if (type.specifier.specifier.type === 'struct') this.struct(type.specifier.specifier);
        this.apart(() => this.declare(one.declaration));
        if (type.qualifiers?.some(({ token }) => token === 'out')) type.qualifiers = null;
      }
    }
    return generate(tree);
  }
}

const trees = new Map();  // a file takes up to two seconds
function treeOf(text) {
  if (!trees.has(text)) trees.set(text, parser.parse(text, { quiet: true, stage: 'either' }));
  return structuredClone(trees.get(text));
}

function counted(files, main) {
  const counting = new Counting();
  return `uvec4 counts_ = uvec4(0u);
uint counted_(uvec4 operations) {
  counts_ += operations;
  return 0u;
}
${files.map(text => counting.file(treeOf(text))).join('\n')}
${main}`;
}

// The text of a fragment shader, given as its files, whose only result are its counts.
export const countedFragment = files => counted(files, `layout(location = 0) out vec4 value_;
void main() {
  counted_main_();
  value_ = vec4(counts_);
}
`);

// The text of a vertex shader that draws its counts as a point, each vertex to a pixel of its own; 'counted_size' is the target's.
export const countedVertex = files => counted(files, `uniform vec2 counted_size;
flat out vec4 of_vertex_;
void main() {
  counted_main_();
  of_vertex_ = vec4(counts_);
  vec2 at = vec2(gl_VertexID % int(counted_size.x), gl_VertexID / int(counted_size.x));
  gl_Position = vec4(2.0 * (at + 0.5) / counted_size - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
`);
export const VERTEX_COUNTS = `flat in vec4 of_vertex_;
out vec4 value_;
void main() {
  value_ = of_vertex_;
}
`;
