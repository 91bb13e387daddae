module expression_symbols
  !! Where an expression finds the values of its names: the interface that the parameters and tables of a deck fill, and
  !! the empty one of plain arithmetic.
  use messages, only: quoted
  use expression_values, only: value, unknown_value
  implicit none (type, external)
  private
  public :: symbol_source, no_symbols

  type, abstract :: symbol_source
    !! Where expressions find parameters and tables. Names arrive in lower case.
  contains
    procedure(find_symbol), deferred :: find_symbol
    procedure(has_table), deferred :: has_table
    procedure(has_key), deferred :: has_key
    procedure(look_up), deferred :: look_up
    procedure(symbol_hint), deferred :: symbol_hint
  end type symbol_source

  abstract interface
    subroutine find_symbol(self, name, v, found)
      import :: symbol_source, value
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
      type(value), intent(out) :: v
      logical, intent(out) :: found
    end subroutine find_symbol

    logical function has_table(self, name)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
    end function has_table

    logical function has_key(self, table, column, key)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: table
      logical, intent(in) :: column          !! a column key, else a row key
      character(*), intent(in) :: key
    end function has_key

    subroutine look_up(self, table, row, column, v, fact, remedy)
      import :: symbol_source, value
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: table, row
      character(*), intent(in) :: column     !! '': the only column
      type(value), intent(out) :: v
      character(:), allocatable, intent(out) :: fact, remedy   !! fact is '' if all is well
    end subroutine look_up

    function symbol_hint(self, name) result(hint)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
      character(:), allocatable :: hint      !! remedy for a name that is not known
    end function symbol_hint
  end interface

  type, extends(symbol_source) :: no_symbols
    !! Plain arithmetic.
  contains
    procedure :: find_symbol => no_symbol
    procedure :: has_table => no_table
    procedure :: has_key => no_key
    procedure :: look_up => no_look_up
    procedure :: symbol_hint => no_hint
  end type no_symbols

contains

  subroutine no_symbol(self, name, v, found)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name
    type(value), intent(out) :: v
    logical, intent(out) :: found

    associate (unused => self, also => name)
    end associate
    v%kind = unknown_value
    found = .false.
  end subroutine no_symbol

  logical function no_table(self, name)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name

    associate (unused => self, also => name)
    end associate
    no_table = .false.
  end function no_table

  logical function no_key(self, table, column, key)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: table
    logical, intent(in) :: column
    character(*), intent(in) :: key

    associate (unused => self, also => table, again => column, too => key)
    end associate
    no_key = .false.
  end function no_key

  subroutine no_look_up(self, table, row, column, v, fact, remedy)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: table, row, column
    type(value), intent(out) :: v
    character(:), allocatable, intent(out) :: fact, remedy

    associate (unused => self, also => row, too => column)
    end associate
    v%kind = unknown_value
    fact = 'there is no table ' // quoted(table)
    remedy = ''
  end subroutine no_look_up

  function no_hint(self, name) result(hint)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: hint

    associate (unused => self, also => name)
    end associate
    hint = ''
  end function no_hint
end module expression_symbols
