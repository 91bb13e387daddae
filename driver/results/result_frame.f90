module result_frame
  !! What is written at one instant: the control values and the fields at the Bezier points of all cells.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: result_field_type, result_frame_type, named_text_type

  type :: result_field_type
    character(:), allocatable :: name        !! as viewers show it
    real(wp), allocatable :: values(:, :)    !! (components,points)
  end type result_field_type

  type :: result_frame_type
    integer :: step = 0
    real(wp) :: time = 0
    real(wp), allocatable :: u(:, :)                        !! control values (ndf,nn)
    type(result_field_type), allocatable :: fields(:)       !! at the points of the cells, `displacement` first
  end type result_frame_type

  type :: named_text_type
    character(:), allocatable :: name, text
  end type named_text_type
end module result_frame
